-- Every problem of scripts/validation at its coarse levels with vectors of 2 and 4 doubles, as far as they are narrower than this
-- processor's, with which validate_quick_long.c runs them: the answers are within their tolerances on other machines, too.
local build = assert(os.getenv("HK_BUILD"))
if build:find("sanitize") then -- what sanitizers see does not depend on the width, and validate_quick_long.c is run under them
  print("skipped: under sanitizers")
  os.exit(77)
end
local flags = (io.open("/proc/cpuinfo") or io.open("/dev/null")):read("a")
local widest = flags:find("avx512f", 1, true) and 8 or flags:find("avx2", 1, true) and 4 or 2
local failed = 0
for lanes = 2, widest // 2, 2 do
  local command = ("HOOKE_LANES=%d '%s/hooke' validate --quick --no-page --quiet --out '%s/test-output/widths' 2>&1"):format(
    lanes, build, build)
  local pipe = assert(io.popen(command))
  local text = pipe:read("a")
  if not pipe:close() then
    failed = failed + 1
    print(("lanes %d:\n%s"):format(lanes, text))
  end
end
os.exit(failed == 0)
