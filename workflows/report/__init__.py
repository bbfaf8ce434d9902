"""What a study says: figures and tables as declarations, sections, the page in HTML and in Markdown."""
