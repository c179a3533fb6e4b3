-- Three runs of each of 60 random scenes with known answers: tests/support/known_laws/run.lua. Of sanitizers one: the verdict is
-- the same there.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
os.exit(require("known_laws.program")(arg, 60, os.getenv("HK_BUILD"):find("sanitize") and 1 or 3))
