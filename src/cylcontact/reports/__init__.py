"""What the bench reports: figures with their numbers, and the ledger of the paper's claims."""
