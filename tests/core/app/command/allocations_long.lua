-- Runs of small scenes with every kind of plugin, in each of which one allocation fails: every thirteenth of those that its
-- plugins and the run cause. See tests/support/allocations/run.lua; memory_long.c has those before.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
os.exit(require("allocations.run")(13))
