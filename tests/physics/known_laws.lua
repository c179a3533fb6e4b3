-- A part of known_laws_long.lua for every day: two runs of each of some scenes of every family.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
os.exit(require("known_laws.program")(arg, 22, 2))
