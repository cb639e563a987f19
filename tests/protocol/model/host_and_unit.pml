/* Hosts and units on a bad link: staging, token, windows, commit, identity, sessions and arming (docs/protocol.md).
 *
 * Checked by `check` beside this file, in every configuration named there. The names are those of docs/protocol.md.
 *
 * What is modelled
 *   serve()     the unit: protocol/server/register_server.cpp, ecs_emulator/unit/commands.cpp
 *   give()      how a host gives a command: protocol/client/client.cpp
 *   Uploader    `ecs map send`: protocol/client/upload.cpp
 *   Operator    a host that gives commands and writes system RAM: arm, disarm, output compensation, output off
 *   Link        loss, repetition and delay of requests, loss of replies; restart of a unit; time; a cable that is moved
 *
 * What is abstracted, and why nothing is hidden by it
 *   - A keyed check agrees only with what its host computed it over, and numbers by chance (session, token) are all
 *     different. The odds against this, 2^-64 for a check and 2^-32 for the numbers, are arithmetic, not protocol.
 *   - Arming is one step, which only who knows the code gets through, in the session that he names: the exchange of keys
 *     itself is not modelled (tests/protocol/registers/keys_test.cpp holds it to its document).
 *   - A forger lacks the keys and may know all else. What he sends is a copy of a request on the line with other
 *     contents, or a request of his own, whose session and token he may guess: `forged`, its keyed check does not agree.
 *     He gives one answer in the place of the unit's as well. Under a key a forged answer is one that was lost.
 *   - The tags of all windows on axis memory are the same: chance may make two alike, and nothing may depend on it.
 *     Windows on system RAM have no token; there the tags of two hosts differ, as they do by chance.
 *   - A map is BLOCKS blocks, a block is the name of its map. Two blocks are enough for a mixture.
 *   - Reading changes nothing in the unit, so a read that comes late does nothing; a reply that comes late has another
 *     echo and is dropped, as if it were lost. The mutation NO_ECHO takes it.
 *   - A host tries a request again as often as it likes, not four times; it may end anywhere ("killed"): more behaviour
 *     than the program has.
 *   - Forgetting the session used least lately is forgetting any session at any time; the end of the minutes of an
 *     armed host is the end at any time. Both are more than the unit does.
 *   - The commit is one step: a record whose last byte is missing is no record, and tests cut the power at every byte.
 *   - Coded blocks are blocks: what they mean depends on memory, but nothing counts before the CRC of the window and of
 *     the image. Busy commands are left out; begin staging and commit are done when they are answered.
 *   - The unit is in integration mode. In the other modes it refuses everything that is looked at here.
 */

/* ---- sizes; `check` gives others ---- */
#ifndef UNITS
#define UNITS 1
#endif
#ifndef PROGRAMS
#define PROGRAMS 1 /* that a host runs one after another */
#endif
#ifndef STRAYS
#define STRAYS 1 /* requests that are on their way at one time beside those that are waited for */
#endif
#ifndef RESTARTS
#define RESTARTS 0
#endif
#ifndef FORGETS
#define FORGETS 0 /* sessions that the unit forgets over those of others */
#endif
#ifndef EXPIRIES
#define EXPIRIES 0 /* armed hosts whose minutes end */
#endif
#ifndef FORGES
#define FORGES 0 /* requests and answers of a forger */
#endif
#ifndef TICKS
#define TICKS 0
#endif
#ifndef MOVES
#define MOVES 0 /* of the cable of host 0 */
#endif
#ifndef COMMANDS
#define COMMANDS 2 /* that an operator gives */
#endif
#ifndef OPERATORS
#define OPERATORS 0 /* hosts that give commands; the others send maps */
#endif
#ifndef KNOWS_0
#define KNOWS_0 true /* host 0 knows the unit's code */
#endif
#ifndef KNOWS_1
#define KNOWS_1 true
#endif
#ifdef OPEN_UNIT
#define ARMING false /* a unit without a code: every host is armed */
#else
#define ARMING true
#endif

#define HOSTS 2
#define BLOCKS 2
#define LIFE 1 /* ticks that a command which acts at once lives: the two seconds */
#define OLD (HOSTS + 1) /* the map that the unit holds at first; host h sends map h + 1 */
#define NOTHING 0

/* Block b of map m: the first block of map 1 is that of the old map, so that one value has changed. */
#define CONTENT(m, b) (((m) == 1 && (b) == 0) -> OLD : (m))
#define AT(bank, b) ((bank) * BLOCKS + (b))
#define WINDOW unit[u].window
#define HOLDS(u, bank, m) \
  (unit[u].memory[AT(bank, 0)] == CONTENT(m, 0) && unit[u].memory[AT(bank, 1)] == CONTENT(m, 1))
#define ALL 3 /* received: a bit for each block */

/* For whom a map is: unit 0, or with two units each host has the map of its own; with WRONG_FILE host 1 sends one that
 * is for nobody here. */
#ifdef WRONG_FILE
#define FOR_UNIT(m, u) ((m) == OLD || (m) != 2)
#else
#define FOR_UNIT(m, u) ((m) == OLD || UNITS == 1 || (m) == (u) + 1)
#endif

mtype:request = { identity, active_map, checks, session_open, command, window_open, block, acknowledgement }
mtype:code = { arm, disarm, begin_staging, commit_staged, abandon_staged, output_compensation, output_off }
mtype:error = { none, idle, no_answer, no_staging, check_mismatch, address_protected, token_expired, other_machine,
                session_unknown, late, overtaken, not_armed, wrong_code, wrong_key }

#define NEEDS_ARMING(c) ((c) == begin_staging || (c) == commit_staged || (c) == output_compensation)

typedef Request {
  mtype:request kind;
  byte host;
  byte program;  /* which number the session was opened with */
  byte session;
  byte sequence;
  mtype:code code;
  byte token;    /* of the staging; in a block: that its check was computed with */
  bit bank;      /* of the addresses */
  bit kept;      /* begin staging: 2, what is there; else 1, a copy of the active bank */
  byte map;      /* commit: SHA-256 of the image; block: payload; checks: what is compared */
  byte tag;
  bit ram;       /* the window is system RAM */
  bit number;    /* of the block */
  byte clock;
  byte stops;
  byte proof;    /* arm: the session that it was computed for; 0: with a wrong code */
  bool forged;   /* the keyed check is not that of its host */
  /* what only the properties look at */
  byte staging;  /* the staging that the host means */
  byte given;    /* bit of the command in what its program gave */
  byte given_at; /* time when the clock that it carries was read */
  byte offs;     /* times that anybody had switched off when the host first asked for the clock */
}

typedef Answer {
  mtype:request kind;
  bool ok;       /* there is one */
  mtype:error error;
  byte session;
  byte sequence;
  byte clock;
  byte stops;
  bool armed;
  byte token;
  byte value;    /* identity: serial number; active map: the map; begin staging: bank; checks, acknowledgement: bits of
                    blocks */
  byte serial;   /* active map: serial number */
  byte commit;   /* commit sequence */
  bit bank;      /* active bank */
  bool forged;   /* by somebody else than the unit */
  bool agrees;   /* acknowledgement: CRC of the window in memory is that of what was sent */
  /* what only the properties look at */
  byte staging;
  byte at;
  byte offs;
}

typedef Session {
  byte id;       /* 0: unknown */
  byte opened;   /* so often: the next number is another one */
  byte sequence; /* of its newest command, and the result of that */
  mtype:error error;
  byte token;
  byte value;
  byte staging;  /* property only */
}

typedef Window {
  byte tag;
  byte session;
  byte program;  /* whose session that is */
  byte token;
  bit bank;
  bit ram;
  byte received;
  mtype:error error;
}

typedef Unit {
  byte memory[4]; /* both banks; with the next three battery-backed */
  bit active_bank;
  byte map;       /* of the commit record */
  byte commit;    /* sequence */
  bool staging;   /* from here on: lost with power */
  byte clock;
  bool restarted; /* since the link looked last: starts differs from the number known */
  byte token;
  byte begun;     /* stagings so far: the next token */
  byte stops;
  Window window;
  bool armed[HOSTS];
  /* what only the properties look at */
  byte staging_now;     /* number of the staging in force; 0: none */
  bool truly_armed[HOSTS];
}

Unit unit[UNITS];
Session session_of[UNITS * HOSTS * PROGRAMS];
#define SESSION(u, p) session_of[(u) * HOSTS * PROGRAMS + (p)]

/* A session and a token are numbers by chance: never those of another unit. */
#ifdef TOKEN_BY_COUNT
#define TOKEN(u) (unit[u].begun)
#else
#define TOKEN(u) (unit[u].begun * UNITS + (u))
#endif

byte cable;            /* the unit that host 0 reaches */
byte time;             /* ticks, of the hosts' clocks */
byte restarts_left = RESTARTS;
byte forgets_left = FORGETS;
byte expiries_left = EXPIRIES;
byte moves_left = MOVES;
byte forges_left = FORGES;
bool knows[HOSTS];     /* the host knows the unit's code */

/* what only the properties look at; a bit for each program */
byte offs;                            /* times that anybody has switched off */
byte acted[HOSTS * PROGRAMS];         /* commands that have acted */
byte met[HOSTS * PROGRAMS];           /* the unit that answered first */
bool truth[HOSTS * PROGRAMS];         /* at its last reading of the active map: that unit's active map is the program's */
bool committed[HOSTS * PROGRAMS];     /* the program's commit was carried out */
bool denied[HOSTS * PROGRAMS];        /* it has told that its map was not taken */

chan call[HOSTS] = [1] of { Request };
chan back[HOSTS] = [0] of { Answer };
#ifdef NO_ECHO
chan late_reply[HOSTS] = [1] of { Answer }; /* a reply that comes when another one is waited for */
#endif
chan stray = [STRAYS] of { Request };

hidden Request rq;
hidden Answer an;
hidden Request out;
hidden Answer in;
hidden byte active_map_is_for_this_unit;
hidden byte active_map_is_no_mixture;
hidden byte block_is_of_the_staging_in_force;
hidden byte command_acts_once;
hidden byte no_command_acts_after_a_stop;
hidden byte no_command_acts_after_its_life;
hidden byte no_write_reaches_the_active_bank;
hidden byte not_taken_is_true;
hidden byte only_an_armed_host_acts;
hidden byte only_an_armed_host_writes;
hidden byte own_command_is_heard;
hidden byte right_code_is_accepted;
hidden byte success_is_true;
#define REQUIRE(name, condition) name = (condition); assert(name)
hidden byte from;
hidden byte u;
hidden byte i;

/* What the runs must get to, or nothing is proved by them: `check` demands that these statements are reached. */
hidden byte seen;
#define reached(n) seen = n

/* ------------------------------------------------------------------------------------------------ the unit ---- */

/* Protocol, "Sessions", "Arming", "The token": after a start nothing of before counts. */
inline forget_hosts_of_another_start() {
#ifdef NO_START
  skip
#else
  if
  :: unit[u].restarted ->
     unit[u].restarted = false;
     unit[u].token = 0;
     unit[u].window.received = 0;
     unit[u].window.error = token_expired;
     for (i : 0 .. HOSTS - 1) { unit[u].armed[i] = false }
     for (i : 0 .. HOSTS * PROGRAMS - 1) { forget_session(i) }
     i = 0
  :: else
  fi
#endif
}

inline forget_session(p) {
  SESSION(u, p).id = 0;
  SESSION(u, p).sequence = 0;
  SESSION(u, p).error = none;
  SESSION(u, p).token = 0;
  SESSION(u, p).value = 0;
  SESSION(u, p).staging = 0
}

#ifdef NO_ARMING
#define IS_ARMED(h) true
#else
#define IS_ARMED(h) (!ARMING || unit[u].armed[h])
#endif
#define TRULY_ARMED(h) ((!ARMING || unit[u].truly_armed[h]) && !rq.forged)
#ifdef NO_KEY
#define KEY_AGREES true
#else
#define KEY_AGREES (!rq.forged) /* without a key: what a stranger uses up of a session is given back with its key */
#endif

/* A staging ends with the next one, with its commit and when it is abandoned. */
inline stage_under(token_now) {
  unit[u].token = token_now;
  unit[u].window.received = 0;
  unit[u].window.error = token_expired
}

/* The active map is whole, is the one of its commit record and is for this unit. */
inline look_at_active_map() {
  REQUIRE(active_map_is_no_mixture, HOLDS(u, unit[u].active_bank, unit[u].map));
  REQUIRE(active_map_is_for_this_unit, FOR_UNIT(unit[u].map, u))
}

inline write_block() {
  REQUIRE(only_an_armed_host_writes, TRULY_ARMED(rq.host));
  REQUIRE(no_write_reaches_the_active_bank, (WINDOW.bank != unit[u].active_bank));
  REQUIRE(block_is_of_the_staging_in_force, (rq.staging == unit[u].staging_now && rq.staging != 0));
  unit[u].memory[AT(WINDOW.bank, rq.number)] = CONTENT(rq.map, rq.number);
  look_at_active_map()
}

inline begin_staging_in_unit() {
  i = 1 - unit[u].active_bank;
  if
  :: !rq.kept ->
     unit[u].memory[AT(i, 0)] = unit[u].memory[AT(unit[u].active_bank, 0)];
     unit[u].memory[AT(i, 1)] = unit[u].memory[AT(unit[u].active_bank, 1)]
  :: else
  fi;
  unit[u].staging = true;
  unit[u].begun++;
  unit[u].staging_now = unit[u].begun * UNITS + u;
  an.value = i;
  an.token = TOKEN(u);
  an.staging = unit[u].staging_now;
  stage_under(TOKEN(u));
  i = 0
}

/* "A map": the unit checks length, SHA-256 and identity itself before it switches banks. */
inline commit_in_unit() {
  i = 1 - unit[u].active_bank;
  if
  :: !unit[u].staging -> an.error = no_staging
#ifndef NO_COMMIT_CHECK
  :: unit[u].staging && !HOLDS(u, i, rq.map) -> an.error = check_mismatch
#endif
#ifndef NO_IDENTITY
  :: unit[u].staging && !FOR_UNIT(rq.map, u) -> an.error = other_machine
#endif
  :: else ->
     unit[u].active_bank = i;
     unit[u].map = rq.map;
     unit[u].commit++;
     unit[u].staging = false;
     unit[u].staging_now = 0;
     an.value = unit[u].commit;
     stage_under(0);
     look_at_active_map();
     REQUIRE(only_an_armed_host_writes, TRULY_ARMED(rq.host));
     REQUIRE(not_taken_is_true, (!denied[rq.program] || u != met[rq.program]));
     committed[rq.program] = true
  fi;
  i = 0
}

inline arm_in_unit() {
  if
  :: rq.code == disarm ->
     unit[u].armed[rq.host] = false;
     unit[u].truly_armed[rq.host] = false
  :: rq.code == arm && rq.proof == rq.session ->
     unit[u].armed[rq.host] = true;
     unit[u].truly_armed[rq.host] = true
  :: else -> an.error = wrong_code
  fi
}

#ifdef NO_LIFE
#define TOO_LATE false
#else
#define TOO_LATE (unit[u].clock - rq.clock > LIFE || unit[u].clock < rq.clock)
#endif
#ifdef NO_STOPS
#define OVERTAKEN false
#else
#define OVERTAKEN (rq.stops != unit[u].stops)
#endif

inline output_in_unit() {
  if
  :: TOO_LATE -> an.error = late
  :: !TOO_LATE && OVERTAKEN -> an.error = overtaken
  :: else ->
     REQUIRE(only_an_armed_host_acts, TRULY_ARMED(rq.host));
     REQUIRE(no_command_acts_after_its_life, (time - rq.given_at <= LIFE));
     REQUIRE(no_command_acts_after_a_stop, (offs == rq.offs));
     REQUIRE(command_acts_once, ((acted[rq.program] & rq.given) == 0));
     acted[rq.program] = acted[rq.program] | rq.given
  fi
}

#ifdef NO_TOKEN
#define OTHER_TOKEN (unit[u].token == 0)
#else
#define OTHER_TOKEN (rq.token != unit[u].token)
#endif

/* "A command": what RegisterServer::outcome_of answers. */
inline carry_out() {
  an.error = none;
  if
  :: rq.code == arm || rq.code == disarm -> arm_in_unit()
  :: NEEDS_ARMING(rq.code) && !IS_ARMED(rq.host) -> an.error = not_armed
  :: rq.code == begin_staging -> begin_staging_in_unit();
     REQUIRE(only_an_armed_host_writes, TRULY_ARMED(rq.host))
  :: (rq.code == commit_staged || rq.code == abandon_staged) && unit[u].token == 0 -> an.error = no_staging
  :: (rq.code == commit_staged || rq.code == abandon_staged) && unit[u].token != 0 && OTHER_TOKEN ->
     an.error = token_expired
  :: rq.code == commit_staged && IS_ARMED(rq.host) && unit[u].token != 0 && !OTHER_TOKEN -> commit_in_unit()
  :: rq.code == abandon_staged && unit[u].token != 0 && !OTHER_TOKEN ->
     unit[u].staging = false;
     unit[u].staging_now = 0;
     stage_under(0)
  :: rq.code == output_compensation && IS_ARMED(rq.host) -> output_in_unit()
  :: rq.code == output_off -> unit[u].stops++; offs++
  fi
}

/* "Sessions": a command that comes again gets its first answer, one that comes after a later one does nothing. */
inline take_command() {
  forget_hosts_of_another_start();
  if
  :: SESSION(u, rq.program).id == 0 || SESSION(u, rq.program).id != rq.session -> an.error = session_unknown
  :: SESSION(u, rq.program).id != 0 && SESSION(u, rq.program).id == rq.session && !KEY_AGREES ->
     reached(17);
     an.error = wrong_key;
     if
     :: rq.code == output_off -> unit[u].stops++; offs++; reached(18)
     :: else
     fi;
#ifdef FORGED_SEQUENCE
     SESSION(u, rq.program).sequence = rq.sequence
#endif
#ifndef NO_SEQUENCE
  :: else ->
     if
     :: rq.sequence < SESSION(u, rq.program).sequence -> an.error = idle
     :: rq.sequence == SESSION(u, rq.program).sequence ->
        an.error = SESSION(u, rq.program).error;
        an.token = SESSION(u, rq.program).token;
        an.value = SESSION(u, rq.program).value;
        an.staging = SESSION(u, rq.program).staging
     :: else ->
#else
  :: else ->
     if
     :: true ->
#endif
        carry_out();
        SESSION(u, rq.program).sequence = rq.sequence;
        SESSION(u, rq.program).error = an.error;
        SESSION(u, rq.program).token = an.token;
        SESSION(u, rq.program).value = an.value;
        SESSION(u, rq.program).staging = an.staging
     fi
  fi
}

inline open_session() {
  forget_hosts_of_another_start();
  if
  :: SESSION(u, rq.program).id == 0 ->
     SESSION(u, rq.program).opened++;
     SESSION(u, rq.program).id = SESSION(u, rq.program).opened * UNITS + u
  :: else
  fi;
  an.session = SESSION(u, rq.program).id;
  an.sequence = SESSION(u, rq.program).sequence;
  an.clock = unit[u].clock;
  an.stops = unit[u].stops;
  an.armed = IS_ARMED(rq.host);
  an.at = time;
  an.offs = offs
}

#ifdef NO_TOKEN
#define WINDOW_EXPIRED (unit[u].token == 0)
#else
#define WINDOW_EXPIRED (rq.token == 0 || rq.token != unit[u].token)
#endif
#ifdef NO_ACTIVE_PROTECTION
#define PROTECTED(bank) false
#else
#define PROTECTED(bank) ((bank) == unit[u].active_bank)
#endif

/* "Writing": the window is opened under a new tag; the one that is open already changes nothing. */
inline open_window() {
  forget_hosts_of_another_start();
  if
  :: !KEY_AGREES -> reached(19) /* leaves the open one as it is */
  :: else -> open_window_of_host()
  fi
}

inline open_window_of_host() {
  if
  :: WINDOW.tag == rq.tag && WINDOW.session == rq.session && WINDOW.token == rq.token && WINDOW.bank == rq.bank &&
     WINDOW.ram == rq.ram && WINDOW.error == none -> skip
  :: else ->
     WINDOW.tag = rq.tag;
     WINDOW.session = rq.session;
     WINDOW.token = rq.token;
     WINDOW.bank = rq.bank;
     WINDOW.ram = rq.ram;
     WINDOW.program = rq.program;
     WINDOW.received = 0;
     if
     :: !rq.ram && WINDOW_EXPIRED -> WINDOW.error = token_expired
     :: !rq.ram && !WINDOW_EXPIRED && PROTECTED(rq.bank) -> WINDOW.error = address_protected
     :: !rq.ram && !WINDOW_EXPIRED && !PROTECTED(rq.bank) && !unit[u].staging -> WINDOW.error = no_staging
     :: else -> WINDOW.error = none
     fi
  fi;
  if
  :: SESSION(u, rq.program).id == 0 || SESSION(u, rq.program).id != rq.session ->
     WINDOW.received = 0;
     WINDOW.error = session_unknown
  :: else ->
     if
     :: !IS_ARMED(rq.host) -> WINDOW.received = 0; WINDOW.error = not_armed
     :: else
     fi
  fi
}

#ifdef NO_BLOCK_ARMING
#define WINDOW_ARMED true
#else
#define WINDOW_ARMED \
  (WINDOW.session != 0 && SESSION(u, WINDOW.program).id == WINDOW.session && IS_ARMED(WINDOW.program / PROGRAMS))
#endif
#ifdef NO_BLOCK_CHECK
#define CHECK_AGREES true
#else
#define CHECK_AGREES (rq.token == WINDOW.token)
#endif

/* A block is taken under the window's tag, with a check over its token, tag, number and payload. */
#ifdef NO_KEY
#define BLOCK_KEY_AGREES true
#else
#define BLOCK_KEY_AGREES (!rq.forged)
#endif
inline take_block() {
#ifndef OLD_BLOCK_AFTER_START
  forget_hosts_of_another_start();
#endif
  an.error = not_armed;
  if
  :: !WINDOW_ARMED -> WINDOW.received = 0; WINDOW.error = not_armed
  :: else
  fi;
  if
  :: WINDOW.error == none && rq.tag == WINDOW.tag && !BLOCK_KEY_AGREES ->
     reached(20); WINDOW.received = 0; WINDOW.error = check_mismatch
  :: WINDOW.error == none && rq.tag == WINDOW.tag && CHECK_AGREES && BLOCK_KEY_AGREES ->
     if
     :: WINDOW.ram ->
        REQUIRE(only_an_armed_host_writes, TRULY_ARMED(rq.host));
        WINDOW.received = WINDOW.received | (1 << rq.number);
        an.error = none
     :: !WINDOW.ram && PROTECTED(WINDOW.bank) -> WINDOW.error = address_protected
     :: !WINDOW.ram && !PROTECTED(WINDOW.bank) && !unit[u].staging -> WINDOW.error = no_staging
     :: else ->
        write_block();
        WINDOW.received = WINDOW.received | (1 << rq.number);
        an.error = none
     fi
  :: else
  fi
}

inline acknowledge() {
  an.error = WINDOW.error;
  an.value = WINDOW.received;
  if
  :: WINDOW.tag != rq.tag || WINDOW.bank != rq.bank -> an.error = token_expired
  :: else
  fi;
  an.agrees = ((WINDOW.received & 1) == 0 || unit[u].memory[AT(WINDOW.bank, 0)] == CONTENT(rq.map, 0)) &&
              ((WINDOW.received & 2) == 0 || unit[u].memory[AT(WINDOW.bank, 1)] == CONTENT(rq.map, 1))
}

inline tell_active_map() {
  an.serial = u;
  an.bank = unit[u].active_bank;
  an.commit = unit[u].commit;
  an.value = (HOLDS(u, unit[u].active_bank, unit[u].map) -> unit[u].map : NOTHING);
  truth[rq.program] = (unit[met[rq.program]].map == rq.map)
}

inline compare_checks() {
  an.value = 0;
  if
  :: unit[u].memory[AT(rq.bank, 0)] == CONTENT(rq.map, 0) -> an.value = an.value | 1
  :: else
  fi;
  if
  :: unit[u].memory[AT(rq.bank, 1)] == CONTENT(rq.map, 1) -> an.value = an.value | 2
  :: else
  fi
}

inline clear_answer() {
  an.kind = identity; an.ok = false; an.error = none; an.session = 0; an.sequence = 0; an.clock = 0; an.stops = 0; an.armed = false;
  an.forged = false; an.token = 0; an.value = 0; an.serial = 0; an.commit = 0; an.bank = 0; an.agrees = false; an.staging = 0; an.at = 0; an.offs = 0
}

/* A window that takes nothing more is as good as any other that does not: the fewer states. */
inline close_window() {
  if
  :: WINDOW.error == none
  :: else ->
     WINDOW.tag = 0; WINDOW.session = 0; WINDOW.program = 0; WINDOW.token = 0; WINDOW.bank = 0; WINDOW.ram = 0;
     WINDOW.received = 0; WINDOW.error = token_expired
  fi
}

/* One request `rq` at the unit, which answers `an`. */
inline serve() {
  u = (rq.host == 0 -> cable : UNITS - 1);
  clear_answer();
  an.kind = rq.kind;
  if
  :: rq.kind == identity -> an.value = u
  :: rq.kind == active_map -> tell_active_map()
  :: rq.kind == checks -> compare_checks()
  :: rq.kind == session_open -> open_session()
  :: rq.kind == command -> take_command()
  :: rq.kind == window_open -> open_window(); acknowledge()
  :: rq.kind == block -> take_block()
  :: rq.kind == acknowledgement -> acknowledge()
  fi;
  an.ok = true;
  close_window()
}

/* ------------------------------------------------------------------------------------------------ the link ---- */

/* Only what changes something in the unit is worth being late. A session that is opened late is used by nobody. */
#define HAS_EFFECT(k) ((k) == command || (k) == window_open || (k) == block)

#define NOBODY HOSTS
#define WINDOW0 unit[0].window
#define IS_ARMED_AT(v, h) unit[v].armed[h]

active proctype Link() {
end:
  do
  /* A request that waits, or one that is on its way, arrives or does not. One that waits is answered; or its reply is
   * lost and the host sends it again; or the host gives up; or a copy stays on its way. What is on its way arrives
   * once, more often, or never. */
  :: atomic {
       if
       :: call[0]?rq -> from = 0
       :: call[1]?rq -> from = 1
       :: stray?rq -> from = NOBODY
       :: stray?rq -> stray!rq; from = NOBODY
       fi;
       if
       :: d_step { serve() };
          if
          :: from != NOBODY -> back[from]!an
          :: from != NOBODY -> call[from]!rq
#ifdef NO_ECHO
          :: from != NOBODY && empty(late_reply[from]) -> late_reply[from]!an; call[from]!rq
#endif
          :: from == NOBODY
          fi
       :: from != NOBODY -> d_step { clear_answer(); an.error = no_answer }; back[from]!an
#ifdef NO_ECHO
       :: from != NOBODY && nempty(late_reply[from]) -> late_reply[from]?an;
          if
          :: an.kind == rq.kind -> back[from]!an
          :: else -> call[from]!rq
          fi
#endif
       :: from != NOBODY && HAS_EFFECT(rq.kind) && nfull(stray) -> stray!rq; call[from]!rq
       :: from == NOBODY
       fi
     }
#if FORGES > 0
  /* A forger who has heard a request sends another one like it, or one of his own. */
  :: atomic { forges_left > 0 ->
       forges_left--;
       if
#ifndef DEAF
       :: call[0]?<rq>
       :: call[1]?<rq>
       :: stray?<rq>
#endif
       :: rq.host = 0; rq.program = 0; rq.session = SESSION(0, 0).id; rq.sequence = 9; rq.token = unit[0].token;
            rq.tag = WINDOW0.tag; rq.bank = WINDOW0.bank; rq.ram = WINDOW0.ram; rq.kept = 0; rq.proof = 0;
          if
          :: rq.kind = command
          :: rq.kind = window_open
          :: rq.kind = block
          fi
       fi;
       rq.forged = true; rq.staging = 0; rq.given = 0; rq.given_at = time; rq.offs = offs;
       if
       :: rq.kind == command ->
          if
          :: rq.code = begin_staging
          :: rq.code = commit_staged
          :: rq.code = abandon_staged
          :: rq.code = output_compensation
          :: rq.code = output_off
          :: rq.code = disarm
          fi;
          if
          :: rq.sequence++
          :: true
          fi;
          rq.clock = unit[0].clock; rq.stops = unit[0].stops
       :: rq.kind == window_open ->
          if
          :: rq.bank = 1 - rq.bank
          :: rq.ram = 1 - rq.ram
          :: rq.token = unit[0].token
          fi
       :: rq.kind == block ->
          if
          :: rq.map = OLD
          :: rq.number = 1 - rq.number
          :: true
          fi
       :: else
       fi;
       d_step { serve() }
     }
  /* He answers a question in the place of the unit, or changes its answer. */
  :: atomic { forges_left > 0 && (nempty(call[0]) || nempty(call[1])) ->
       if
       :: call[0]?rq -> from = 0
       :: call[1]?rq -> from = 1
       fi;
       forges_left--;
       if
       :: d_step { serve() }
       :: d_step { clear_answer(); an.kind = rq.kind; an.session = rq.session; an.sequence = rq.sequence }
       fi;
       an.ok = true; an.forged = true; an.error = none;
       if
       :: rq.kind == active_map -> an.value = rq.map
       :: rq.kind == checks || rq.kind == window_open || rq.kind == acknowledgement -> an.value = ALL; an.agrees = true
       :: else
       fi;
       if
#ifdef NO_ANSWER_CHECK
       :: true -> back[from]!an
#else
       :: !IS_ARMED_AT(0, from) -> forges_left++; call[from]!rq /* who has no key asks for a session only: no property */
       :: IS_ARMED_AT(0, from) -> reached(21); call[from]!rq
#endif
       fi
     }
#endif
#if RESTARTS > 0
  /* The unit loses what is in RAM and keeps what the battery holds. */
  :: atomic { restarts_left > 0 ->
       restarts_left--;
       u = (UNITS == 1 -> 0 : cable);
       d_step {
         unit[u].restarted = true; unit[u].staging = false; unit[u].staging_now = 0; unit[u].clock = 0;
         for (i : 0 .. HOSTS - 1) { unit[u].truly_armed[i] = false }
         i = 0
       }
     }
#endif
#if FORGETS > 0
  :: atomic { forgets_left > 0 && SESSION(0, 0).id != 0 -> forgets_left--; u = 0; forget_session(0) }
#endif
#if EXPIRIES > 0
  :: atomic { expiries_left > 0 && unit[0].armed[0] ->
       expiries_left--; unit[0].armed[0] = false; unit[0].truly_armed[0] = false }
#endif
#if TICKS > 0
  :: atomic { time < TICKS -> time++; unit[0].clock++ }
#endif
#if MOVES > 0
  :: atomic { moves_left > 0 -> moves_left--; cable = 1 - cable }
#endif
  od
}

/* ------------------------------------------------------------------------------------------------ the host ---- */

/* What a program remembers; every host has these. */
#define A_HOST(h) \
  byte p = (h) * PROGRAMS; \
  byte session; \
  byte sequence; \
  byte clock; \
  byte stops; \
  byte proof; \
  byte given; \
  byte given_at; \
  byte switched; \
  bool again; \
  mtype:error result = idle; \
  mtype:code doing = arm; \
  byte token; \
  byte staging; \
  byte held; \
  byte missing; \
  bool refused; \
  bit bank; \
  bit kept

inline clear_request(k) {
  out.kind = k; out.host = h; out.program = p; out.session = session; out.sequence = 0; out.code = arm; out.token = 0;
  out.bank = 0; out.kept = 0; out.map = h + 1; out.tag = 0; out.ram = 0; out.number = 0; out.clock = 0; out.stops = 0;
  out.proof = 0; out.forged = 0; out.staging = 0; out.given = 0; out.given_at = 0; out.offs = 0
}

/* The result of an earlier command is asked for by nobody any more: the fewer states. */
inline forget_result() {
  for (u : 0 .. UNITS - 1) {
    SESSION(u, p).error = none;
    SESSION(u, p).token = 0;
    SESSION(u, p).value = 0;
    SESSION(u, p).staging = 0
  }
  u = 0
}

/* One request and its own reply: Link::ask. All between two of these is one step of the host. */
inline ask() {
  forget_result();
  call[h]!out;
  back[h]?in
}

/* UnitClient::session_now */
inline session_now() {
  clear_request(session_open);
  ask();
  if
  :: in.ok && in.session != session -> session = in.session; sequence = in.sequence
  :: else
  fi
}

/* UnitClient::arm: `result` is idle if the command was not answered */
inline arm_host() {
  proof = session;
  do
  :: sequence++;
     clear_request(command);
     out.sequence = sequence;
     out.code = arm;
     out.proof = proof;
     ask();
     if
     :: in.ok && in.error == session_unknown ->
        session_now();
#ifndef PROOF_OF_BEFORE
        proof = session;
#endif
        if
        :: !in.ok -> result = no_answer; break
        :: else
        fi
     :: in.ok && in.error != session_unknown -> result = in.error; break
     :: !in.ok -> result = no_answer; break
     fi
  od;
  proof = 0;
  REQUIRE(right_code_is_accepted, (result != wrong_code))
}

/* UnitClient::armed_session: `result` is none if the session is open; it is armed if the code is known, once more where
 * the unit was restarted since */
inline open_session_for(writing) {
  session_now();
  result = (in.ok -> none : no_answer);
  do
  :: result == none && (writing) && !in.armed && knows[h] ->
     arm_host();
     if
     :: result == none -> session_now(); result = (in.ok -> none : no_answer)
     :: else -> break
     fi
  :: else -> break
  od
}

/* UnitClient::run with make_ready, of the command `doing`: `result` is the error that it ended with; what else was
 * answered is in `in`. `which` is the bit of this command, for the properties. */
inline give(which) {
  again = false;
  do
  :: if
     :: session == 0 || NEEDS_ARMING(doing) ->
        open_session_for(NEEDS_ARMING(doing));
        clock = in.clock;
        given_at = in.at;
        if
        :: !again -> switched = in.offs; stops = in.stops
        :: else
#ifdef REGIVEN_AFRESH
           -> stops = in.stops
#endif
        fi
     :: else -> result = none
     fi;
     if
     :: result != none -> break
     :: else
     fi;
     again = true;
     sequence++;
     clear_request(command);
     out.sequence = sequence;
     out.code = doing;
     out.kept = kept;
     out.token = token;
     out.staging = staging;
     out.clock = clock;
     out.stops = stops;
     out.given = which;
     out.given_at = given_at;
     out.offs = switched;
     ask();
     result = (in.ok -> in.error : no_answer);
     REQUIRE(own_command_is_heard, (!in.ok || in.error != idle || FORGES == 0));
     if
     :: result == session_unknown -> session = 0;
#ifndef REGIVEN_AFRESH
        if
        :: NEEDS_ARMING(doing) && doing != begin_staging ->
           break /* its session was there just before: it may have been carried out */
        :: else
        fi
#endif
     :: result == not_armed && knows[h] /* the time has ended since: armed again */
     :: result == late -> reached(9) /* by the host's clock there is time yet */
     :: else -> break
     fi
  od;
  clock = 0; stops = 0; given_at = 0; switched = 0; again = false
}

/* UnitClient::send_missing: a block that the unit does not take has its reason, which the acknowledgement tells. */
inline send_block(b, in_ram) {
  if
  :: refused || ((missing >> b) & 1) == 0
  :: else ->
     clear_request(block);
     out.tag = (in_ram -> 2 + h : 1);
     out.token = token;
     out.number = b;
     out.staging = staging;
     ask();
     refused = in.ok && in.error != none
  fi
}

/* UnitClient::write_window: `result` is none if everything is there */
inline request_window(in_ram) {
  clear_request(window_open);
  out.tag = (in_ram -> 2 + h : 1);
  out.token = token;
  out.bank = bank;
  out.ram = in_ram
}

inline write_window(in_ram) {
  request_window(in_ram);
  do
  :: ask();
     if
     :: !in.ok -> result = no_answer; break
     :: in.ok && in.error == not_armed && knows[h] -> /* the time has ended since: armed again, if in this session */
        given_at = session;
        open_session_for(true);
        if
        :: result == none && session == given_at -> reached(16); given_at = 0; request_window(in_ram)
        :: else -> given_at = 0; result = not_armed; break
        fi
     :: in.ok && in.error != none && !(in.error == not_armed && knows[h]) -> result = in.error; break
     :: in.ok && in.error == none && (in.value | held) == ALL ->
        result = (in.agrees -> none : check_mismatch);
        break
     :: else ->
        missing = ALL - (in.value | held);
        send_block(0, in_ram);
        send_block(1, in_ram);
        missing = 0;
        refused = false;
        if
        :: result = no_answer; break /* no block comes through, or it is killed */
        :: true
        fi;
        clear_request(acknowledgement);
        out.tag = (in_ram -> 2 + h : 1);
        out.bank = bank
     fi
  od
}

#ifdef NO_SAME_UNIT
#define OF_ANOTHER_UNIT false
#else
#define OF_ANOTHER_UNIT (in.serial != serial)
#endif

#if OPERATORS < HOSTS
/* `ecs map send`, PROGRAMS times: the second one goes on where the first one was killed, or sends the same map again. */
proctype Uploader(byte h) {
  A_HOST(h);
  byte serial;
  bit before_bank;
  byte before_commit;
  byte commit;
  bool settling;

  atomic {
    skip;
next_program:
    clear_request(identity); /* UnitClient::connect */
    ask();
    if
    :: !in.ok -> goto ended
    :: else -> serial = in.value; met[p] = in.value
    fi;
    /* upload_image */
    clear_request(active_map);
    ask();
    if
    :: !in.ok || OF_ANOTHER_UNIT -> goto ended
    :: else -> before_bank = in.bank; before_commit = in.commit
    fi;
    if
    :: in.value == h + 1 -> goto same_map
    :: else
    fi;
    /* beginning_for: from the active map, or from what an earlier transfer has left */
    clear_request(checks);
    out.bank = before_bank;
    ask();
    if
    :: !in.ok -> goto ended
    :: else -> held = in.value
    fi;
    clear_request(checks);
    out.bank = 1 - before_bank;
    ask();
    if
    :: !in.ok -> goto ended
    :: in.ok && (in.value == ALL || held == 0) -> held = in.value; kept = 1
    :: else
    fi;
    doing = begin_staging;
    goto give_command;
begun:
    if
    :: result != none -> goto given_up
    :: else -> token = in.token; bank = in.value; staging = in.staging
    fi;
    if
    :: bank != 1 - before_bank -> goto given_up
    :: else
    fi;
    if
    :: held != ALL ->
       if
       :: held != 0 -> reached(4)
       :: else
       fi;
       write_window(0)
    :: else -> reached(5)
    fi;
    if
    :: result != none -> goto given_up
    :: else
    fi;
    /* nothing_else_committed */
    clear_request(active_map);
    ask();
    if
    :: !in.ok || OF_ANOTHER_UNIT -> result = no_answer; goto given_up
    :: in.ok && !OF_ANOTHER_UNIT && (in.commit != before_commit || in.bank != before_bank) -> result = idle; goto given_up
    :: else
    fi;
    doing = commit_staged;
give_command:
    give(0);
    if
    :: doing == begin_staging -> goto begun
    :: doing == abandon_staged && !settling -> goto ended
    :: doing == abandon_staged && settling -> goto abandoned
    :: doing == commit_staged && result == other_machine -> reached(12); goto settled
    :: doing == commit_staged && result != none && result != other_machine -> goto settled
    :: else -> commit = in.value
    fi;

    /* confirmed: whether it still is, at the end of this link */
    clear_request(active_map);
    ask();
    if
    :: !in.ok -> goto ended /* told: taken, not looked at afterwards */
    :: in.ok && OF_ANOTHER_UNIT -> reached(14); goto ended /* the same, and that another unit answers */
    :: in.ok && !OF_ANOTHER_UNIT && (in.commit != commit || in.value != h + 1) -> reached(6); goto ended /* told: another map is active */
    :: else
    fi;
    reached(1);
    goto same_map;

settled: /* the commit was not answered with `done`: the unit itself says what became of it */
    settling = true;
    doing = abandon_staged;
#ifndef LOOK_BEFORE_ABANDON
    goto give_command;
abandoned:
#endif
    clear_request(active_map);
    ask();
    if
    :: !in.ok || OF_ANOTHER_UNIT -> goto ended /* told: not known which map is active */
    :: in.ok && !OF_ANOTHER_UNIT && in.commit != before_commit ->
       if
       :: in.value != h + 1 -> goto ended /* told: another map is active */
       :: else -> reached(2); goto same_map
       fi
    :: else
    fi;
#ifndef LOOK_BEFORE_ABANDON
    if
    :: result == no_answer -> reached(7); goto ended /* told: not known */
    :: else
    fi;
#endif
#ifdef LOOK_BEFORE_ABANDON
    goto give_command;
abandoned:
#endif
    reached(13);
    REQUIRE(not_taken_is_true, !committed[p]);
    denied[p] = true;
    goto ended;

same_map: /* this unit names the map that was to be sent: success */
    REQUIRE(success_is_true, truth[p]);
    if
    :: !committed[p] -> reached(3)
    :: else
    fi;
    goto ended;

given_up: /* before any commit: what is staged is abandoned, unless the unit refused */
    if
    :: result == no_answer || result == check_mismatch || result == none -> doing = abandon_staged; goto give_command
    :: else
    fi;

ended:
    result = idle; doing = arm; settling = false; serial = 0; before_bank = 0; before_commit = 0; token = 0; staging = 0; held = 0; refused = false;
    bank = 0; kept = 0; commit = 0; session = 0; sequence = 0;
    forget_result();
    truth[p] = false;
    committed[p] = false;
    p++;
    if
    :: p < (h + 1) * PROGRAMS -> goto next_program
    :: else -> p = 0
    fi
  }
}

#endif

#if OPERATORS > 0
/* Commands in any order. */
proctype Operator(byte h) {
  A_HOST(h);
  byte left = COMMANDS;
  byte which = 1; /* bit of the command that was given last */

  atomic {
    do
    :: left > 0 ->
       left--;
       if
       :: if
          :: doing = output_compensation; which = which * 2
          :: doing = output_off
          :: doing = disarm
          fi;
          give(which);
          if
          :: result == not_armed -> reached(8)
          :: result == overtaken -> reached(10)
          :: result == none && doing == output_compensation -> reached(11)
          :: else
          fi;
          doing = arm
       :: open_session_for(true); /* UnitClient::write_memory */
          if
          :: result == none -> write_window(1); reached(15)
          :: else
          fi
       fi;
       result = idle
    :: left > 0 -> break
    :: left == 0 -> break
    od;
    left = 0; which = 0; session = 0; sequence = 0
  }
}
#endif

init {
  atomic {
    for (u : 0 .. UNITS - 1) {
      unit[u].memory[AT(0, 0)] = OLD;
      unit[u].memory[AT(0, 1)] = OLD;
      unit[u].memory[AT(1, 0)] = CONTENT(2, 0); /* what an earlier transfer of host 1 has left */
      unit[u].map = OLD;
      unit[u].commit = 1;
      unit[u].window.error = token_expired
    }
    knows[0] = KNOWS_0;
    knows[1] = KNOWS_1;
#if OPERATORS > 1
    run Operator(0);
#else
    run Uploader(0);
#endif
#ifdef ALONE
    skip /* no other host */
#elif OPERATORS > 0
    run Operator(1)
#else
    run Uploader(1)
#endif
  }
}
