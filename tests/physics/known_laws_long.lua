-- Three runs of each of 60 random scenes with known answers: tests/support/known_laws/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
os.exit(require("known_laws.program")(arg, 60, 3))
