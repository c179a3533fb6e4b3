-- `hooke run --integrator auto` reaches the accuracy on twenty scenes that it was not tuned on: tests/support/unseen. An
-- argument is the name of one of them.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local unseen = require("unseen.run")
local pipe = assert(io.popen("mktemp -d"))
local folder = pipe:read("l")
pipe:close()
local build = assert(os.getenv("HK_BUILD"))
local budget = build:find("sanitize") and 60 or nil -- all takes ten times as long there
local good, count = unseen.measure { hooke = build .. "/hooke", folder = folder, only = arg[1], budget = budget }
os.execute("rm -rf '" .. folder .. "'")
os.exit(good == count)
