"""What a study says: tables from the files of its runs."""
