-- Files and words of the shell, for tests in Lua.
local files = {}

function files.quoted(text) return "'" .. text:gsub("'", "'\\''") .. "'" end

function files.write(path, text)
  local file = assert(io.open(path, "wb"))
  file:write(text)
  file:close()
end

function files.read(path)
  local file = io.open(path, "rb")
  local text = file and file:read("a")
  if file then file:close() end
  return text
end

-- A new and empty folder, which the test removes.
function files.folder()
  local folder = os.tmpname()
  os.remove(folder)
  assert(os.execute("mkdir -p " .. files.quoted(folder)))
  return folder
end

return files
