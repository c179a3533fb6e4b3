-- `hooke run --integrator auto` reaches the accuracy on twenty scenes that it was not tuned on: tests/support/unseen. An
-- argument is the name of one of them.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local unseen = require("unseen.run")
local pipe = assert(io.popen("mktemp -d"))
local folder = pipe:read("l")
pipe:close()
local good, count = unseen.measure { hooke = assert(os.getenv("HK_BUILD")) .. "/hooke", folder = folder, only = arg[1] }
os.execute("rm -rf '" .. folder .. "'")
os.exit(good == count)
