std = "lua54"
max_line_length = 140
read_globals = { "hooke", "param" }
