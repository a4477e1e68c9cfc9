"""Faludi, Zentai, Zelechowski, Zam, Rauter, Griessen, Cattin: Transfer-Function-Independent Acceleration Structure for Volume
Rendering in Virtual Reality, 2021: Table 1, Figures 4 to 7 and the claims of sections 4.3 to 4.5."""
