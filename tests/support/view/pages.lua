-- Pages for tests, made by a tool of the tests' own: a tree beside which the built hooke finds it as it finds its tools,
-- so that native modules run in the program that they were built for, with sanitizers too.
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
  shell("mkdir -p %s/build %s/tools/templates", tree, tree)
  shell("cp '%s/hooke' %s/build/hooke && ln -s '%s/plugins' '%s/tools' %s/build/", build, tree, build, build, tree)
  shell("ln -s '%s/scripts' %s/scripts && ln -s '%s/tools/common' '%s/tools/view' %s/tools/", root, tree, root, root, tree)
  shell("ln -s '%s/tests/support' %s/tools/support && ln -s '%s/tests/support/view/write_pages.lua' %s/tools/", root, tree,
    root, tree)
  shell("%s/build/hooke write_pages %s", tree, folder)
  return folder
end

return pages
