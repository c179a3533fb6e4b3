-- Every attempt of scenes never to end; endless.lua tries some. See tests/support/attempts/run.lua.
package.path = (os.getenv("HK_ROOT") or ".") .. "/tests/support/?.lua;" .. package.path
os.exit(require("attempts.run")({ "endless" }, arg[1]))
