-- What modules.lua tries, and the handbook, whose lessons are runs of many commands.
assert(loadfile(assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/tools/modules.lua"))(true)
