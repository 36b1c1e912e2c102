// usage: node dbc_against_candied.js CANDIED DBC LOG INTERFACE OURS
// Decodes a candump log by the npm package candied and compares with our words ("id signal raw value" a line, OURS).
// Prints the number of values compared; exit status 1 where any differs, or where there is nothing to compare.
'use strict';
const fs = require('fs');
const {Dbc, Can} = require(process.argv[2]);
const [dbcFile, logFile, network, oursFile] = process.argv.slice(3);

const can = new Can();
// candied passes over signals whose numbers have an exponent; the same numbers without one are the same doubles.
can.database = new Dbc().load(fs.readFileSync(dbcFile, 'utf8').replace(/1e-06/g, '0.000001'));
const ours = fs.readFileSync(oursFile, 'utf8').trim().split('\n');

let at = 0, raws = 0, values = 0, different = 0, held = 0;
for (const line of fs.readFileSync(logFile, 'utf8').trim().split('\n')) {
    const [, name, frame] = line.split(' ');
    const [id, data] = frame.split('#');
    if (network && name !== network) continue;
    const bytes = data.match(/../g).map(pair => parseInt(pair, 16));
    const message = can.decode(can.createFrame(parseInt(id, 16), bytes));
    if (!message) continue;
    const theirs = message.boundSignals;
    for (let i = 0; i < theirs.size; ++i, ++at) {
        const [ourId, signal, raw, value] = (ours[at] || '').split(' ');
        const word = theirs.get(signal);
        const limits = can.getMessageById(parseInt(id, 16)).signals.get(signal);
        const same = word && Number(ourId) === parseInt(id, 16) && word.rawValue === Number(raw);
        // candied holds a decoded value within the file's minimum and maximum; we give what was sent.
        const outside = limits && (Number(value) < limits.min || Number(value) > limits.max) && limits.min < limits.max;
        ++raws;
        held += outside ? 1 : 0;
        values += outside ? 0 : 1;
        if (!same || (!outside && word.value !== Number(value))) {
            if (++different <= 10) {
                console.log(`differs: ${line} ${signal}: candied ${word && word.rawValue} ${word && word.value}, ` +
                            `ours ${raw} ${value}`);
            }
        }
    }
}
console.log(`${dbcFile}: ${raws} raw and ${values} scaled values compared, ${held} beyond their limits, ` +
            `${different} differ`);
process.exit(different === 0 && raws > 0 && at === ours.length ? 0 : 1);
