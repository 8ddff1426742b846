"""The HTML target: one page for each protocol, to read, to search, and to decode and encode with.

`emit` is the entry. A page needs no network and no other file. What is read is the Markdown
target's text; the bench beside it is made of the files in `page/` and of the TypeScript target's
codec.
"""
