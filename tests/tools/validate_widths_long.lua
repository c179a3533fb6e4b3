-- Every problem of scripts/validation at its coarse levels with vectors of 2, 4 and 8 doubles, as far as this processor has
-- them: the answers are within their tolerances on other machines, too.
local build = assert(os.getenv("HK_BUILD"))
if build:find("sanitize") then -- what sanitizers see does not depend on the width, and validate_quick_long.c is run under them
  print("skipped: under sanitizers")
  os.exit(77)
end
local failed = 0
for _, lanes in ipairs { 2, 4, 8 } do
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
