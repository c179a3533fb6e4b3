-- One page of one or two recordings.
local json_text = require("common.view.json_text")
local encode = require("common.view.encode")
local shared = require("common.view.shared")
local template = require("common.view.template")
local difference = require("common.view.difference")

local make = {}

local function write(out, runs, what)
  local page_data = { runs = json_text.list(), bench = what.bench and json_text.raw(what.bench) }
  for k, run in ipairs(runs) do
    local fine, data, why = pcall(encode.run, run.recording, out,
      { title = run.title, summary = run.summary, tick = what.tick }) -- a damaged recording raises an error
    if not (fine and data) then return nil, ("%s: %s"):format(run.title, fine and why or data:gsub("^%S+:%d+: ", "")) end
    page_data.runs[k] = data
  end
  if #runs == 2 then page_data.difference = difference.of(runs[1].recording, runs[2].recording) end
  page_data.shared = shared.page_data(out)
  local fine, size = out:finish(page_data)
  if not fine then return nil, size end
  return { size = size, runs = page_data.runs, difference = page_data.difference }
end

-- runs: one or two { recording, title, summary (JSON text or nil) }; what: title, subtitle, bench (JSON text or nil), tick.
-- What was written, { size, runs }; or nil and the reason: then there is no new file.
function make.page(path, runs, what)
  local out, why = template.begin(path, what)
  if not out then return nil, why end
  local made
  made, why = write(out, runs, what)
  out:close()
  return made, why
end

return make
