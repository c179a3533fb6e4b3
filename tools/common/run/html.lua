-- Text as HTML has it.
local html = {}

local entity = { ["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;" }

function html.escape(text) return (text:gsub('[&<>"]', entity)) end

return html
