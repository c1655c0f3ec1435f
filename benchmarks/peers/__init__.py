"""Other libraries that can march a field, each written as its users would write it: compare.py times them.

`tasks.py` says what is to be rendered, `fields.py` has the text of the scenes that they share, and each module that
`registry.py` names is one contender: its ``prepare(task)`` returns a function that renders and returns a new array. In
the process of a peer nothing imports octomarch.
"""
