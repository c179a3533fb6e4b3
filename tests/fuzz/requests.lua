-- Random requests to the server of `hooke run --watch`: right ones with wrong words, methods, lengths and bodies, halves of
-- requests, bytes. Afterwards it still answers its page, and the run ends by SIGINT; see tests/support/fuzz/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local values = require("fuzz.values")
local bytes = require("fuzz.bytes")
local chance, pick = values.chance, values.pick

if not io.open(assert(os.getenv("HK_BUILD")) .. "/tools/server.so") then
  print("skipped: built without libmicrohttpd")
  os.exit(77)
end

local scene = [[
local k = param("k", 10, "stiffness", { min = 0, max = 1000 })
local s = hooke.scene { duration = 1000, fps = 50, integrator = "leapfrog" }
local h = s:strand { n = 4, from = { 0, 0, 0 }, to = { 1, 0, 0 } }
s:pin { 1 }
s:force("gravity", {})
s:force("springs", { edges = h:edges(), k = k })
return s
]]

-- Sends the files request.1, ... one by one, asks for the page, and stops the run, whose process is named.
local client = [[
for wait in $(seq 200); do url=$(grep -ao 'http://[^ ]*' .err | head -n 1); [ "$url" ] && break; sleep 0.02; done
host=${url#http://}; token=${host#*/}; token=${token%/}; host=${host%%/*}
for file in request.*; do
  { exec 3<>/dev/tcp/127.0.0.1/${host##*:}; } 2>/dev/null || { echo no connection; break; }
  sed "s|HOST|$host|g; s|TOKEN|$token|g" $file >&3 2>/dev/null
  timeout 0.1 cat <&3 >/dev/null 2>&1
  exec 3>&-
done
printf 'page %s\n' "$(curl -s -m 20 -o /dev/null -w '%{http_code}' "$url")"
kill -INT $1
]]

local paths = { "/TOKEN/", "/TOKEN/state", "/TOKEN/command", "/TOKEN/page.js", "/TOKEN/frame/1/0", "/TOKEN/frame/1/99999999999",
  "/TOKEN/frame/-1/x", "/", "//", "/../../etc/passwd", "/TOKEN/%2e%2e/x", "/TOKEN/command?do=stop", "*", "" }
local commands = { '{"do":"pause"}', '{"do":"go"}', '{"do":"step"}', '{"do":"again","params":{"k":5}}', '{"do":"again","params":{"k":"x"}}',
  '{"do":"hold","id":2,"to":[0,0,1]}', '{"do":"hold","id":9e99,"to":[1e308,null]}', '{"do":"pace","pace":-1}', '{"do":', "[]", "null",
  '"', ("["):rep(5000), '{"do":"no such"}', '{"do":"release"}', "" }

local function request()
  local method = pick { "GET", "GET", "POST", "POST", "HEAD", "PUT", "X" }
  local body = method == "POST" and pick(commands) or ""
  if chance(0.3) then body = bytes.text(body .. " ") end
  local length = chance(0.8) and #body or pick { -1, 0, 1, 99999999999, "x" }
  local text = ("%s %s HTTP/1.1\r\nHost: %s\r\nOrigin: http://HOST\r\nContent-Type: %s\r\nContent-Length: %s\r\n%s\r\n%s"):format(
    method, pick(paths), chance(0.8) and "HOST" or "evil.example", chance(0.8) and "application/json" or "text/plain", length,
    chance(0.2) and "Transfer-Encoding: chunked\r\n" or "", body)
  if chance(0.3) then text = bytes.binary(text) end
  return text
end

run.fuzz {
  name = "requests",
  cases = 3,
  make = function()
    local files = { ["scene.lua"] = scene, ["client.sh"] = client }
    for k = 1, math.random(1, 12) do files["request." .. k] = request() end
    return { files = files, words = "run scene.lua --watch --at-once --no-output --quiet", seconds = 20,
      before = [[bash -c 'bash client.sh $$ & exec "$@"' it]],
      check = function(_, out) if not out:find("page 200", 1, true) then return "its page is no longer there: " .. out:sub(1, 200) end end }
  end,
}
