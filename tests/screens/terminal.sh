# Driving `ecs` in a real terminal (tmux). Sourced by the tests that do; they set $ecs and $ECS_EMULATOR first.
# Says nothing on its own; the first thing that is not as it should be ends the test with the screen as it was.
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
export ECS_SAMPLES=$source/samples
work=${ECS_TEST_FOLDER:-$(mktemp -d)}
export ECS_STATE_DIR=$work/state HOME=$work XDG_CONFIG_HOME=$work/config
name=ecs-screens-$$
t() { tmux -L "$name" -f /dev/null "$@"; }
trap 't kill-server 2>/dev/null || true; rm -rf "$work"' EXIT

start() { # WIDTH HEIGHT ENVIRONMENT…
  t kill-server 2>/dev/null || true
  sleep 0.4
  t new-session -d -x "$1" -y "$2" "cd $work && env ${*:3} $ecs; echo left with \$?; sleep 1000"
  t set -g window-size manual
}
seen() { t capture-pane -p; }
wait_for() { # TEXT SECONDS (60)
  for _ in $(seq $(( ${2:-60} * 10 ))); do
    if seen | grep -qF -- "$1"; then return; fi
    sleep 0.1
  done
  echo "NOT SEEN: $1"
  seen
  exit 1
}
not_there() {
  if seen | grep -qF -- "$1"; then
    echo "SEEN, but should not be: $1"
    seen
    exit 1
  fi
}
keys() { t send-keys "$@"; sleep 0.15; }
program() { pgrep -P "$(t display -p '#{pane_pid}')" -x ecs; }
emulator() { pgrep -P "$(program)" -x ecs-emulator || true; }
restored() { # the terminal as the shell left it: main screen, cursor on, no mouse
  wait_for "left with $1"
  state=$(t display -p '#{alternate_on} #{cursor_flag} #{mouse_any_flag}')
  [ "$state" = "0 1 0" ] || { echo "terminal not restored: $state"; exit 1; }
}
only_ascii() {
  if seen | LC_ALL=C grep -qP '[\x80-\xff]'; then
    echo "signs beyond ASCII"
    seen
    exit 1
  fi
}
