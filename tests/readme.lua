-- Every Lua block of README.md and scripts/README.md can be pasted: a whole scene runs as it stands, and a fragment where
-- it gets the scene, and the `return scene`, that it lacks. None is warned of. What a line offers "in its place" is tried
-- in that place. Links of all READMEs lead somewhere. plugins/README.md is for contract.lua, core/README.md for engine.lua.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")

local function read(path)
  local file = assert(io.open(path))
  local text = file:read("a")
  file:close()
  return text
end

local function blocks_of(path)
  local list = {}
  for text in read(path):gmatch("\n```lua\n(.-\n)```") do list[#list + 1] = text end
  return list
end

-- Fragments that drive a scene need something in it that moves.
local function completed(block)
  local head, tail = "", ""
  if not block:find("hooke.scene", 1, true) then
    head = "local scene = hooke.scene { duration = 2 }\n"
    if block:find("scene:run", 1, true) then head = head .. "scene:particle { mass = 1 }\nscene:force('gravity')\n" end
  end
  if not block:find("\nreturn scene", 1, true) then tail = "return scene\n" end
  return head .. block .. tail
end

-- The block itself, and where it has a comment "-- in its place[...]: CODE" the one with that in the place of the line
-- before.
local function variants(block)
  local list, lines = { block }, {}
  for line in block:gmatch("[^\n]*\n") do
    lines[#lines + 1] = line
    local other = line:match("^%-%- in its place[^:]*: (scene:.*)$")
    if other then list[#list + 1] = table.concat(lines, "", 1, #lines - 2) .. other end
  end
  return list
end

local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))

-- Whether it runs without a word, and what it said.
local function runs(text)
  local file = assert(io.open(folder .. "/block.lua", "w"))
  file:write(text)
  file:close()
  local fine = os.execute(("cd '%s' && '%s/hooke' run block.lua --until 0.002 --no-output --quiet >said 2>&1"):format(
    folder, build))
  local said = read(folder .. "/said")
  return fine and not said:find("hooke:", 1, true), said
end

local planted = completed(
  'local c = scene:strand { n = 3, mass = 1 }\nscene:force("springs", { edges = c:edges(), k = 1 })\n')
local right, said_of_it = runs(planted)
assert(right, said_of_it)
assert(not runs((planted:gsub("k = 1", "stifness = 1"))), "a wrong parameter is not found")
assert(not runs((planted:gsub("c:edges%(%)", "{}"))), "a warning is not found")
assert(#variants('a()\n-- in its place, for x: scene:b()\n') == 2)

local count = 0
for _, name in ipairs { "README.md", "scripts/README.md" } do
  for k, block in ipairs(blocks_of(root .. "/" .. name)) do
    for _, text in ipairs(variants(block)) do
      local fine, said = runs(completed(text))
      assert(fine, ("%s, block %d: %s\n%s"):format(name, k, said, text))
      count = count + 1
    end
  end
end
-- ---- links ----

-- As GitHub makes them of headings.
local function anchors(text)
  local found = {}
  for heading in text:gmatch("\n#+ ([^\n]+)") do found[heading:lower():gsub("[^%w%- _]", ""):gsub(" ", "-")] = true end
  return found
end

-- Links of pages of Markdown lead to files that are here, and to headings in them.
local links = 0
for path in assert(io.popen(("cd '%s' && ls *.md */*.md scripts/*/README.md tests/*/README.md tools/*/README.md"):format(root))):lines() do
  local here = path:match("^(.*)/") or "."
  for to in read(root .. "/" .. path):gsub("```.-```", ""):gmatch("%]%(([^%)%s]+)%)") do
    local file, anchor = to:match("^([^#]*)#?(.*)$")
    local target = file == "" and path or here .. "/" .. file
    if not to:find("^%a+:") then
      assert(io.open(root .. "/" .. target), ("%s: there is no %s"):format(path, to))
      assert(anchor == "" or anchors("\n" .. read(root .. "/" .. target))[anchor], ("%s: there is no heading for %s"):format(path, to))
      links = links + 1
    end
  end
end
assert(links > 50, links)

os.execute(("rm -rf '%s'"):format(folder))
print(("%d blocks and what they offer in the place of a line"):format(count))
assert(count >= 12, "the blocks are not found")
