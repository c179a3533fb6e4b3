-- The language of scenes as a manual page for troff, hooke-scene(7).
local reference = require("common.handbook.reference")

local manual_page = {}

-- Text as troff takes it: no line is a request, and a minus is one.
local function plain(text) return (text:gsub("\\", "\\e"):gsub("%-", "\\-"):gsub("^([.'])", "\\&%1"):gsub("\n([.'])", "\n\\&%1")) end

local function entry(e, out)
  out[#out + 1] = ".SS " .. plain(e.form)
  out[#out + 1] = plain(e.text .. (e.gives and (" Gives %s."):format(e.gives) or ""))
  for _, row in ipairs(e.takes or {}) do
    local about = (row.unit ~= "-" and row.unit .. ", " or "") .. (row.default == "required" and "required" or "default " .. row.default)
    out[#out + 1] = (".TP\n.B %s\n%s (%s)"):format(plain(row.name), plain(row.text), plain(about))
  end
  if e.example and e.example ~= "" then out[#out + 1] = (".PP\n.nf\n%s\n.fi"):format(plain(e.example)) end
end

function manual_page.text()
  local out = { ".TH HOOKE-SCENE 7 \"\" \"hooke\" \"Scenes of hooke\"", ".SH NAME", "hooke-scene \\- the language of hooke's scenes",
    ".SH DESCRIPTION", "What a script may call. Units are SI; a default of \\- is none." }
  for _, part in ipairs(reference.parts) do
    out[#out + 1] = ".SH " .. part.title:upper()
    for _, e in ipairs(part.entries) do entry(e, out) end
  end
  out[#out + 1] = ".SH SEE ALSO\n.BR hooke (1)"
  return table.concat(out, "\n") .. "\n"
end

return manual_page
