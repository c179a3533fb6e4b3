-- Attempts of scenes never to end, every 40th; endless_long.lua tries all. See tests/support/attempts/run.lua.
package.path = (os.getenv("HK_ROOT") or ".") .. "/tests/support/?.lua;" .. package.path
os.exit(require("attempts.run")({ "endless" }, arg[1], 40))
