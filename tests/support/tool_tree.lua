-- Scripts of tests as tools of hooke: a tree beside which the built hooke finds them as it finds its own tools, so that
-- native modules run in the program that they were built for, with sanitizers too.
local tool_tree = {}

local function shell(format, ...)
  local command = format:format(...)
  assert(os.execute(command), command)
end

-- In the folder; the script's name without .lua is then a command of FOLDER/build/hooke.
function tool_tree.plant(root, build, script, folder)
  shell("mkdir -p %s/build %s/tools/templates", folder, folder)
  shell("cp '%s/hooke' %s/build/hooke && ln -s '%s/plugins' '%s/tools' %s/build/", build, folder, build, build, folder)
  shell("ln -s '%s/scripts' %s/scripts && ln -s '%s/tools/common' '%s/tools/view' %s/tools/", root, folder, root, root, folder)
  shell("ln -s '%s/tests/support' %s/tools/support && ln -s '%s/%s' %s/tools/", root, folder, root, script, folder)
end

-- Runs the script to its end as a tool; its exit code.
function tool_tree.run(root, build, script)
  local pipe = assert(io.popen("mktemp -d"))
  local folder = pipe:read("l")
  pipe:close()
  tool_tree.plant(root, build, script, folder)
  local _, how, code = os.execute(("%s/build/hooke %s"):format(folder, script:match("([%w_]+)%.lua$")))
  shell("rm -rf %s", folder)
  return how == "exit" and code or 1
end

-- The module that reads recordings; where hooke is built without HDF5 the test, in its tree, is skipped.
function tool_tree.recording()
  local built, recording = pcall(require, "recording")
  if built then return recording end
  print("skipped: hooke is built without HDF5")
  os.exit(77)
end

return tool_tree
