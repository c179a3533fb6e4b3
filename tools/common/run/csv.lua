-- Cells of tables (CSV, RFC 4180). What is in them may be a stranger's name, and spreadsheets compute what begins with
-- = + - @ or a tab: such a text gets an apostrophe ahead, by which they know a text. A number stays one.
local csv = {}

-- Quotes are where they have to be, or where `quoted` says so.
function csv.text(text, quoted)
  if text:find("^[=+%-@\t\r]") and not tonumber(text) then text = "'" .. text end
  return (quoted or text:find('[,"\r\n]')) and '"' .. text:gsub('"', '""') .. '"' or text
end

-- A value; numbers that are not whole by the format (%.17g restores every double), nil as an empty cell.
function csv.cell(value, format)
  if value == nil then return "" end
  if math.type(value) == "float" then return (format or "%.17g"):format(value) end
  return csv.text(tostring(value))
end

return csv
