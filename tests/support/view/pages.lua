-- Pages for tests, made by a tool of the tests' own.
local tool_tree = require("support.tool_tree")
local pages = {}

local function shell(format, ...)
  local command = format:format(...)
  assert(os.execute(command), command)
end

-- Writes the pages of write_pages.lua into a new folder; its path.
function pages.write(root, build)
  local pipe = assert(io.popen("mktemp -d"))
  local folder = pipe:read("l")
  pipe:close()
  local tree = folder .. "/tree"
  tool_tree.plant(root, build, "tests/support/view/write_pages.lua", tree)
  shell("%s/build/hooke write_pages %s", tree, folder)
  return folder
end

return pages
