"""The fast engine of generated modules: straight-line functions for records and frames.

Each function does what construct and the runtime's machine do, for bytes and values that are in
order. Whatever is not makes it raise, and then the reference decides and says what is wrong. So a
function may give up wherever it likes, but what it accepts the reference must accept, alike.
"""
