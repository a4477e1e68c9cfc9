"""The regression gate: two builds measured in turns, judged by what is exact, by instructions and by time."""
