-- Attempts of scenes to take all memory, every 16th; greedy_long.lua tries all. See tests/support/attempts/run.lua.
package.path = (os.getenv("HK_ROOT") or ".") .. "/tests/support/?.lua;" .. package.path
-- Sanitizers are so slow that limits of time end these before those of memory: skipped there.
if (os.getenv("HK_BUILD") or ""):find("sanitize") then os.exit(77) end
os.exit(require("attempts.run")({ "greedy" }, arg[1], 16))
