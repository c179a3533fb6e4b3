-- Files of results: written completely or not at all, so that a full disk costs nothing that was there before.
local lfs = require("lfs")

local file = {}

local function put(path, text, direct)
  local handle, why
  if direct then handle, why = io.open(path, "wb") else handle, why = hooke.create(path) end
  if not handle then return nil, why end
  local fine, cause = handle:write(text)
  local closed, reason = handle:close()
  return fine and closed, cause or reason
end

-- Returns true, or nil and "cannot write PATH: the cause". A device is written directly.
function file.write(path, text)
  local mode = lfs.attributes(path, "mode")
  local direct = mode ~= nil and mode ~= "file"
  local part = direct and path or path .. ".part"
  local fine, why = put(part, text, direct)
  if fine and not direct then fine, why = os.rename(part, path) end
  if fine then return true end
  if not direct then os.remove(part) end
  why = why or "the disk is full?"
  return nil, ("cannot write %s: %s"):format(path, why:sub(1, #part + 2) == part .. ": " and why:sub(#part + 3) or why)
end

-- Makes the folder and those above it. Whether it is there, or nil and a sentence.
function file.make_folder(path)
  local above = path:sub(1, 1) == "/" and "/" or ""
  for part in path:gmatch("[^/]+") do
    above = above .. part
    local _, why = lfs.mkdir(above)
    local what = lfs.attributes(above, "mode")
    if what ~= "directory" then
      why = what and ("%s is a %s"):format(above, what) or ("%s: %s"):format(above, why)
      return nil, ("cannot make the folder %s: %s; name another folder"):format(path, why)
    end
    above = above .. "/"
  end
  return true
end

return file
