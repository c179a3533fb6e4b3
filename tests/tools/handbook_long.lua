-- The handbook is built whole: its lessons run and say what their texts say, every link and picture leads somewhere, its
-- annotations are Lua, troff takes its manual page.
-- Under sanitizers what its lessons say is the same there, and tests of the tools run the same code.
if assert(os.getenv("HK_BUILD"), "HK_BUILD"):find("sanitize") then os.exit(77) end
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD")

local function output_of(format, ...)
  local pipe = assert(io.popen(format:format(...) .. " 2>&1"))
  local text = pipe:read("a")
  local fine = pipe:close()
  return text, fine
end

local function read(path)
  local file = assert(io.open(path))
  local text = file:read("a")
  file:close()
  return text
end

local place = output_of("mktemp -d"):gsub("%s", "")
local said, fine = output_of("'%s/hooke' docs '%s' --quiet", build, place)
assert(fine and said == "", said)

local pages = 0
for name in output_of("cd '%s' && ls *.html", place):gmatch("%S+") do
  local text = read(place .. "/" .. name)
  pages = pages + 1
  for kind, to in text:gmatch(' (%a+)="([^"]+)"') do
    local inside = (kind == "href" or kind == "src") and not to:find("^https?:")
    assert(not inside or io.open(place .. "/" .. to), ("%s leads to %s, which is not there"):format(name, to))
  end
end
assert(pages > 20, ("only %d pages"):format(pages))

-- What the lessons promise: 2 + 2 - 9.81/2 m, 6 (1 - exp(-1/2)) m, orders 1 and 4, and a verdict that is not ok of none.
assert(read(place .. "/1-particle.html"):find("height%s+%-0%.905"))
local way = tonumber(read(place .. "/2-forces.html"):match("\n  way +(%d[%d.]+)"))
assert(math.abs(way - 6 * (1 - math.exp(-0.5))) < 2e-3, way)
local errors = {}
for value in read(place .. "/3-steps.html"):gmatch("\n  error +([%d.e+-]+) m RMS against the exact") do
  errors[#errors + 1] = tonumber(value)
end
assert(#errors == 5 and errors[1] > 10 * errors[3] and math.abs(errors[4] / errors[5] - 16) < 2, table.concat(errors, ", "))
assert(not read(place .. "/4-string.html"):find("verdict%s+inaccurate"))

assert(loadfile(place .. "/hooke.d.lua"))
output_of("'%s/hooke' docs --manual '%s/scene.7'", build, place)
if output_of("command -v groff") ~= "" then
  said = output_of("groff -man -Tutf8 -ww '%s/scene.7' >/dev/null", place)
  assert(said == "", said)
end
said, fine = output_of("'%s/hooke' docs /proc/none", build)
assert(not fine and said:find("cannot make the folder /proc/none", 1, true), said)
os.execute(("rm -r '%s'"):format(place))
