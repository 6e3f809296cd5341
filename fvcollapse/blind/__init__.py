"""The blind check: sealed synthetic experiments, and the scores of the answers to them.

- What is hidden: `set_ups`, `causes`, `outside` (causes outside the catalogue), `generator` (labels drawn).
- How it is sealed: `truth` (runs), `measurement` (films of the runs), `labels`, `seal`, `make`.
- How it is answered: `case_evidence`, `evidence_file`, `answers`, `simple_rules`, `verdict_training`.
- How it is scored: `outcomes`, `metrics`, `calibration`, `comparisons`, `distances`, `score`, `score_table`.

`forms` holds the forms of the files, `plain_values` their types for hints. Nothing in
`fvcollapse.diagnosis` imports from here.
"""
