-- Attempts of scenes to take all memory; see tests/support/attempts/run.lua.
package.path = (os.getenv("HK_ROOT") or ".") .. "/tests/support/?.lua;" .. package.path
os.exit(require("attempts.run")({ "greedy" }, arg[1]))
