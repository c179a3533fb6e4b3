-- Queries to hooke with a small answer that load much (the catalogue loads every plugin with its libraries): they run
-- in a process of their own, so that this memory does not make each fork of a case slower.
local json = require("cjson").new()
local process = require("process")

local child = {}

-- The result of f, as far as JSON can represent it.
function child.ask(f)
  local pid, fd = process.fork()
  if pid == 0 then
    local fine, answer = pcall(f)
    if answer == nil then answer = json.null end
    process.write(fd, json.encode { fine = fine, answer = fine and answer or tostring(answer) })
    process.exit(0)
  end
  local parts = {}
  repeat
    parts[#parts + 1] = process.read(fd)
  until parts[#parts] == ""
  process.close(fd)
  local how, code = process.wait(pid)
  local fine, said = pcall(json.decode, table.concat(parts))
  if not fine then error(("sweep: asking for the plugins crashed (%s %d)"):format(how, code), 0) end
  if not said.fine then error(said.answer, 0) end
  if said.answer == json.null then return nil end
  return said.answer
end

-- { { kind, name, path, params = { { name } } } }: the part of hooke.catalogue() that a sweep needs.
local function plugins_here()
  local list = {}
  for k, plugin in ipairs((hooke.catalogue())) do
    local params = {}
    for j, p in ipairs(plugin.params) do params[j] = { name = p.name } end
    list[k] = { kind = plugin.kind, name = plugin.name, path = plugin.path, params = params }
  end
  return list
end

function child.plugins()
  return child.ask(plugins_here)
end

return child
