"""How sure the coefficients are.

Two different questions, never mixed. Measured data carry *noise*: coefficients then have standard
errors, confidence intervals and prediction bands (`report`, `likelihood`, `resampling`, `bands`).
A reference law carries none: what is left over is *model discrepancy*, and the question is how far
a coefficient may move before the fit gets noticeably worse (`discrepancy`).
"""
