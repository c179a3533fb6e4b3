-- Some of the runs of allocations_long.lua: every 263rd allocation of each. See tests/support/allocations/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
os.exit(require("allocations.run")(263))
