"""Fuzzing: what comes from a file, a network or a command line is damaged on purpose, and only a clear refusal may come out.

`target` says what holds for every input, `*_targets` what is fuzzed, `seeds` gives good inputs, `mutation` damages them, `engines` chooses
the damage (guided by coverage where atheris is installed, else by hypothesis), `run` shares out the time. `corpus.zip` holds inputs
that reached something; Testing/Python/tools/test_fuzz_corpus.py runs them on every submission.
"""
