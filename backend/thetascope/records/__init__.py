"""Records of real plants: read files, map columns to a plant's quantities, list what is peculiar."""
