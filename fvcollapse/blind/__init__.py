"""The blind check: sealed synthetic experiments, and the scores of the answers to them.

`generator` draws what is hidden, `outside` holds the causes that no catalogue knows, `truth` runs
them, `measurement` reads them off as a laboratory would, `make` writes the experiment folders and
the seal, `score` opens it, `suite` trains the verdict of the diagnosis on cases of the same kind.
Nothing in `fvcollapse.diagnosis` imports from here.
"""
