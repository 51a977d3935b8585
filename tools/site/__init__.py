"""The documentation as a site: pages of docs/, and the reference from the schemas and the command line."""
