"""The uncertainty of fitted coefficients, for measurements and for reference laws.

Measurements carry *noise*: coefficients have standard errors, confidence intervals and prediction
bands (`estimates`, `profiles`, `resampling`, `bands`). A reference law carries none: the
residuals are *model discrepancy*, and the question is how far a coefficient may move before the
fit gets noticeably worse (`discrepancy`). The two are never mixed.
"""
