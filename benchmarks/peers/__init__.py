"""Other libraries that can march a field, each written as its users would write it: compare.py times them.

`tasks.py` says what is to be rendered, `fields.py` has the text of the scenes that the libraries share, and every other
module here but `worker.py` is one contender: ``prepare(task)`` returns a function that renders the task and returns a
new array. Nothing here imports octomarch but `octomarch_engine.py`.
"""
