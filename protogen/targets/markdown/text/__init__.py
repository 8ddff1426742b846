"""Words, links and tables of Markdown."""
