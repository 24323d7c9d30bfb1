#!/usr/bin/env bash
# make_corpus.sh BIN_FOLDER: writes the seeds in corpus/, from which the fuzz programs in BIN_FOLDER begin. Needs protoc.
set -euo pipefail
bin=$(cd "$1" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
idl=$(cd "$here/../../idl" && pwd)
pages=$here/corpus/page_input
requests=$here/corpus/http_upgrade
clients=$here/corpus/foxglove_input
rm -f "$here/corpus/cdr"/*-{empty,sample} "$here"/corpus/{decisions/one,mcap/whole}
mkdir -p "$pages" "$requests" "$clients"

encode() { protoc --encode=conav.console.ClientMessage -I "$idl" console.proto <<<"$1"; }
byte() { printf '%b' "\\x$(printf '%02x' "$1")"; }

# message TEXT: behind its length, as page_input_fuzz.cc reads it.
message() {
  local size
  size=$(encode "$1" | wc -c)
  byte $((size % 256))
  byte $((size / 256))
  encode "$1"
}

# page NAME JOINED TEXT...: a page that said hello (1) or not (0), and what it sends then.
page() {
  local file=$pages/$1 joined=$2
  shift 2
  {
    byte "$joined"
    for text in "$@"; do message "$text"; done
  } >"$file"
}

hello='hello { name: "anna" instance: "0123456789abcdef" run: "1.1" sequence: 3 }'
cells='{ row: 1 column: 2 }'
page hello 0 "$hello" "$hello"
page token 0 'hello { token: "observer-observer" name: "Zoë" instance: "0123456789abcdef" }'
page ping 1 'ping { page_time: 1.5 measured_round_trip: 0.02 }' 'ping { measured_round_trip: nan }'
page attend 1 'attend { robots: "r1" }' 'attend { robots: "r1" robots: "r2" }' 'attend { }'
page seek 1 'seek { position: 2.5 speed: 2 }'
page edit 1 "request { id: 1 valid_until: 2000 world: \"w1\" edit { base_revision: 3 cells { cell $cells wall: true } } }"
page guide 1 "request { id: 2 valid_until: 2000 world: \"w1\" guide { robot: \"r1\" path $cells path $cells valid_for: 60 } }"
page drive 1 'request { id: 3 valid_until: 2000 world: "w1" drive { robot: "r1" action: DRIVE_FORWARD expires_at: 2 } }'
page select 1 'request { id: 4 valid_until: 2000 world: "w1" select { robot: "r1" reason: REASON_BLOCKED } }'
page answer 1 'request { id: 5 world: "w1" answer { robot: "r1" snapshot: 3 } }'
page stop 1 'request { id: 6 stop { robots: "r1" reason: "fire" } }' 'request { id: 7 resume { robots: "r1" } }'
page control 1 'request { id: 8 take_control { robots: "r1" reason: "mine" } }' \
  'request { id: 9 release_control { robots: "r1" } }'
page alert 1 'request { id: 10 acknowledge { alert: 1 } }' 'request { id: 11 shelve { alert: 1 duration: 60 } }'

host=$'Host: 127.0.0.1:8080\r\n'
upgrade=$'Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n'
upgrade+=$'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n'

# request NAME PIECE TEXT...: bytes of a connection that come PIECE at a time, 0 = as many as can.
request() {
  local file=$requests/$1 piece=$2
  shift 2
  {
    byte "$piece"
    printf '%s' "$@"
  } >"$file"
}

# frame NAME OPCODE FILE: after an upgrade, one frame with what is in FILE, masked with zeros. Below 126 bytes.
frame() {
  request "$1" 0 $'GET /ws HTTP/1.1\r\n' "$host" "$upgrade" $'\r\n'
  {
    byte $((0x80 + $2))
    byte $((0x80 + $(wc -c <"$3")))
    printf '\0\0\0\0'
    cat "$3"
  } >>"$requests/$1"
}

request page 0 $'GET / HTTP/1.1\r\n' "$host" $'Accept-Encoding: gzip\r\nIf-None-Match: "0123", W/"4567"\r\n\r\n'
request two 7 $'GET /livez HTTP/1.1\r\n' "$host" $'\r\nHEAD /readyz HTTP/1.1\r\n' "$host" $'\r\n'
request picture 0 $'GET /pictures/r1/7.jpg HTTP/1.1\r\n' "$host" $'Authorization: Bearer observer-observer\r\n\r\n'
request body 0 $'POST / HTTP/1.1\r\n' "$host" $'Content-Length: 5\r\n\r\n12345'
request chunked 0 $'POST / HTTP/1.1\r\n' "$host" $'Transfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n'
request chunked_pieces 1 $'GET / HTTP/1.1\r\n' "$host" $'Transfer-Encoding: chunked\r\n\r\n0\r\nabc\r\n0\r\n\r\n'
request close 0 $'GET /metrics HTTP/1.0\r\n' "$host" $'Connection: close\r\n\r\n'
request foreign 0 $'GET /ws HTTP/1.1\r\nHost: evil.example\r\nOrigin: http://evil.example\r\n' "$upgrade" $'\r\n'
request upgrade 1 $'GET /ws HTTP/1.1\r\n' "$host" $'Origin: http://127.0.0.1:8080\r\n' "$upgrade" $'\r\n'
request elsewhere 0 $'GET / HTTP/1.1\r\n' "$host" "$upgrade" $'\r\n'
scratch=$(mktemp)
trap 'rm -f "$scratch"' EXIT
encode "$hello" >"$scratch"
frame ws_hello 2 "$scratch"
printf 'ping' >"$scratch"
frame ws_ping 9 "$scratch"
printf '\x03\xe8' >"$scratch"
frame ws_close 8 "$scratch"

# client NAME MESSAGE...: what a client of Foxglove's protocol sends, as foxglove_input_fuzz.cc reads it: a text where it
# begins with a brace, else bytes as printf has them.
client() {
  local file=$clients/$1 message
  shift
  for message in "$@"; do
    # shellcheck disable=SC2059
    printf "$message" >"$scratch"
    byte $(($(wc -c <"$scratch") % 256))
    byte $(($(wc -c <"$scratch") / 256))
    if [[ $message == '{'* ]]; then byte 1; else byte 0; fi
    cat "$scratch"
  done >"$file"
}

client subscribe '{"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]}' \
  '{"op":"unsubscribe","subscriptionIds":[0,1]}'
client goal '{"op":"advertise","channels":[{"id":1,"topic":"/r1/goal_pose","encoding":"json","schemaName":"geometry_msgs/PoseStamped"}]}' \
  '\1\1\0\0\0{"header":{"frame_id":"map","stamp":{"sec":1,"nsec":2}},"pose":{"position":{"x":1},"orientation":{"w":1}}}' \
  '\1\1\0\0\0\0\1\0\0\3\0\0\0ab\0' '{"op":"unadvertise","channelIds":[1]}'
client call '\2\1\0\0\0\7\0\0\0\4\0\0\0json{}' '\2\2\0\0\0\7\0\0\0\3\0\0\0cdr\0\1\0\0'
client parameters '{"op":"getParameters","parameterNames":["/operator.a"],"id":"q"}' \
  '{"op":"setParameters","parameters":[{"name":"/operator.a","value":{"b":[1]}}],"id":"q"}'
client graph '{"op":"subscribeConnectionGraph"}' '{"op":"unsubscribeConnectionGraph"}'
client asset '{"op":"fetchAsset","uri":"package://conav/r1.urdf","requestId":7}'

mkdir -p "$here/corpus/cdr"
CONAV_FUZZ_SEEDS=$here/corpus/cdr "$bin/cdr_fuzz"
CONAV_FUZZ_SEEDS=$here/corpus "$bin/file_fuzz"

# text READER NAME TEXT: a file of that reader of file_fuzz.cc.
text() {
  mkdir -p "$here/corpus/$1"
  printf '%b' "$3" >"$here/corpus/$1/$2"
}

text yaml service 'x:\n  ros__parameters:\n    port: 8080\n    tls: {certificate: a, key: b}\n    origins: [https://a]\n'
text yaml map 'image: a.pgm\nresolution: 0.05\norigin: [-1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n'
text yaml anchors 'a: &a {b: [1, 2]}\nx: {ros__parameters: {<<: *a, idle_s: .nan}}\n'
text tokens one "{\"tokens\": [{\"name\": \"a\", \"role\": \"admin\", \"ends_s\": 1e9, \"sha256\": \"$(printf '%064d' 1)\"}]}"
text csv wide 'subject,a,b\n1,2.5,3\n2,"4",5e-1\n3,6,7\n'
text csv long 'subject;condition;value\r\n1;a;2,5\r\n1;b;3\r\n'
text map pgm 'P2\n# a comment\n5 4\n255\n0 254 254 254 254\n254 254 0 254 254\n254 205 254 254 254\n254 254 254 254 254\n'
text map raw 'P5 4 4 255\n\0376\0376\0376\0376\0376\0376\0376\0376\0376\0376\0376\0376\0376\0376\0376\0376'
place='\xa8norm_pos\x92\xcb\x3f\xe0\0\0\0\0\0\0\x01\xa9timestamp\x05\xaaconfidence\x01'
text pupil_message pupil "\\0\x86\xa2id\0${place}\xa8diameter\x07\xabdiameter_3d\x03"
text pupil_message gaze "\x01\x83$place"
text pupil_message fixation "\x02\x85\xa2id\x07${place}\xa8duration\xcd\x01\x2c"
text pupil_message blink '\x03\x82\xa4type\xa5onset\xa9timestamp\x05'
text pupil_message surface "\x04\x82\xa4name\xa1a\xb0gaze_on_surfaces\x91\x83$place"
text pupil_message annotation '\x05\x83\xa5label\xa1b\xa9timestamp\x05\xa1k\x91\xc3'
