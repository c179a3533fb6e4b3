-- Two runs of libhooke in two threads share no memory that one of them writes: Helgrind watches tests/library/threads. The C
-- library keeps no stacks of ended threads: it gives them to new threads under a lock of its own, which Helgrind does not see.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")

if not os.execute("command -v valgrind >/dev/null") or build:find("sanitize", 1, true) then
  print("skipped: no valgrind, or a build with sanitizers, which does not go with it")
  os.exit(77)
end
local pipe = assert(io.popen(("cd '%s/scripts/scenes' && GLIBC_TUNABLES=glibc.pthread.stack_cache_size=0 \\\n" ..
  "valgrind --tool=helgrind '%s/library/threads' string.lua oscillator.lua 2>&1"):format(root, build)))
local said = pipe:read("a")
assert(pipe:close(), said)
assert(said:find("the same bits", 1, true) and said:find("ERROR SUMMARY: 0 errors", 1, true), said)
