-- Tests of a tool in a folder of their own: what it is given, what it says, and what it refuses.
local files = require("files")

local tool_runs = {}

-- options: of every run, such as "--quiet".
function tool_runs.new(build, tool, options)
  local runs = { folder = os.tmpname() }
  os.remove(runs.folder)
  assert(os.execute("mkdir -p " .. files.quoted(runs.folder)))

  function runs.write(name, text) files.write(runs.folder .. "/" .. name, text) end
  function runs.read(name) return assert(files.read(runs.folder .. "/" .. name), name) end

  -- The exit code and all that is printed. `before`: a program that runs it.
  function runs.hooke(words, before)
    local pipe = io.popen(("cd %s && %s %s/hooke %s %s 2>&1"):format(runs.folder, before or "", build, words, options or ""))
    local text = pipe:read("a")
    local _, _, code = pipe:close()
    return code, text
  end

  function runs.run(arguments, before) return runs.hooke(tool .. " " .. arguments, before) end

  -- Ends with the exit code 1 and one sentence that has these words.
  function runs.refused(arguments, wanted)
    local code, text = runs.run(arguments)
    assert(code == 1 and text:find(wanted, 1, true) and not text:find("\n.", 1), ("%s: exit %d: %s"):format(arguments, code, text))
  end

  -- Ends with another exit code than 0, and words before or after these.
  function runs.fails(arguments, wanted)
    local code, text = runs.run(arguments)
    assert(code ~= 0 and text:find(wanted, 1, true), ("%s: exit %d: %s"):format(arguments, code, text))
  end

  function runs.close() os.execute("rm -rf " .. files.quoted(runs.folder)) end

  return runs
end

return tool_runs
