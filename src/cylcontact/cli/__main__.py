"""`python -m cylcontact.cli`, the same as `cylcontact`."""

from cylcontact.cli import main

main()
