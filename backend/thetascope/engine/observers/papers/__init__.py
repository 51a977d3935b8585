"""The observers of the four papers, one file each."""
