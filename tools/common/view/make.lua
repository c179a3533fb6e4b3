-- One page of one or two recordings.
local json_text = require("common.view.json_text")
local encode = require("common.view.encode")
local template = require("common.view.template")
local difference = require("common.view.difference")

local make = {}

local function write(out, runs, what)
  local story = { runs = json_text.list(), bench = what.bench and json_text.raw(what.bench) }
  for k, run in ipairs(runs) do
    local fine, told, why = pcall(encode.run, run.recording, out,
      { title = run.title, summary = run.summary, tick = what.tick }) -- a damaged recording raises an error
    if not (fine and told) then return nil, ("%s: %s"):format(run.title, fine and why or told:gsub("^%S+:%d+: ", "")) end
    story.runs[k] = told
  end
  if #runs == 2 then story.difference = difference.of(runs[1].recording, runs[2].recording) end
  story.colours = encode.colours(out)
  local fine, size = out:finish(story)
  if not fine then return nil, size end
  return { size = size, runs = story.runs, difference = story.difference }
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
