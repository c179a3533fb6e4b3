-- `hooke run --integrator auto` reaches the accuracy on twenty scenes that it was not tuned on: tests/support/unseen. An
-- argument is the name of one of them. Under sanitizers, where a choice has a tenth of the time, every third is tried, and none is
-- called ok that is not.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local unseen = require("unseen.run")
local pipe = assert(io.popen("mktemp -d"))
local folder = pipe:read("l")
pipe:close()
local build = assert(os.getenv("HK_BUILD"))
local slow = build:find("sanitize") ~= nil
local good, count = unseen.measure { hooke = build .. "/hooke", folder = folder, only = arg[1], slow = slow,
  every = slow and 3 or 1 }
os.execute("rm -rf '" .. folder .. "'")
os.exit(good == count)
