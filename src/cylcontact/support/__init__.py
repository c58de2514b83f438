"""What every package uses: errors, arrays, named choices, texts, progress and parallel calls."""
