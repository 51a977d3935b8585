// The sentences of the diagnosis.

import {language} from './words.js';

const count = (n, one, many) =>
  `${['No', 'One', 'Two', 'Three', 'Four', 'Five', 'Six', 'Seven', 'Eight', 'Nine'][n] ?? n} ${n === 1 ? one : many}`;
const capital = (words) => words && words.replace(/^[a-z](?=[a-z])/, (first) => first.toUpperCase()); // a symbol stays as it is

const en = {
  noDiagnosis: ({note}) => `No diagnosis: ${note}.`,
  broken: ({at}) => `The plant broke down at ${at}: nothing can be judged from there on. Go back to before it.`,
  lost: ({label, at, count: n, all, only}) =>
    only
      ? `No fault found. But ${label} diverged at ${at}, and nothing is estimated any more.`
      : all
        ? `No fault found. But all ${n} observers have diverged, and nothing is estimated any more.`
        : n > 1
          ? `No fault found. But ${n} observers have diverged.`
          : `No fault found. But ${label} diverged at ${at}.`,
  early: ({from}) => `Nothing found yet; judging from ${from} s on.`,
  quiet: () => 'No fault. All is quiet.',
  quietAgain: () => 'All faults are over.',
  ending: () => 'The fault has ended; its alarm is about to clear.',
  one: ({name, kind, size, since}) => `${capital(name)}${kind ? ` ${kind} fault` : ''}: ${size} since ${since}.`,
  oneFound: ({name, kind, size, since, took}) =>
    `${capital(name)}${kind ? ` ${kind} fault` : ''}: ${size} since ${since}, found in ${took}.`,
  oneAgain: ({name, kind, size, since, again}) =>
    `${capital(name)}${kind ? ` ${kind} fault` : ''}: ${size} since ${since}. The one of ${again} came before that alarm was over.`,
  several: ({count: n}) => `${count(n, 'fault, named', 'faults, all named')}.`,
  allNamed: ({count: n, name, took}) =>
    `${count(n, 'fault, named', 'faults, all named')}. ${capital(name)} was found ${took} after it began.`,
  either: ({names}) => `${capital(names.join(' or '))}: this input does not tell them apart.`,
  unexplained: ({name}) => `No fault of the model explains ${name}. Suspect its sensor.`,
  looking: ({name, count: n, open}) =>
    n > 0
      ? `${count(n, 'fault is', 'faults are')} named. ${capital(name)} is not found yet.`
      : `${open > 1 ? `${count(open, '', 'faults')} act` : 'A fault acts'}. Not found yet.`,
  hidden: ({name, count: n}) =>
    `${n > 0 ? `${count(n, 'fault is', 'faults are')} named. ` : ''}${capital(name)} acts unseen: it is not identifiable with this input.`,
  measurement: ({name}) => `The measurement ${name} is disturbed. Not found yet.`,
  falseAlarm: ({name}) => `${capital(name)} is alarmed, though no fault acts there.`,
  blamed: ({name, otherName, onChannel}) =>
    `${capital(name)} is blamed for ${onChannel ? otherName : `the disturbed measurement ${otherName}`}.`,
};

const zh = {
  noDiagnosis: ({note}) => `没有诊断：${note}。`,
  broken: ({at}) => `对象于 ${at} 失控，此后无法判断。请回到此前的时刻。`,
  lost: ({label, at, count: n, all, only}) =>
    only
      ? `未发现故障。但 ${label} 于 ${at} 发散，不再有任何估计。`
      : all
        ? `未发现故障。但全部 ${n} 个观测器都已发散，不再有任何估计。`
        : n > 1
          ? `未发现故障。但有 ${n} 个观测器发散。`
          : `未发现故障。但 ${label} 于 ${at} 发散。`,
  early: ({from}) => `尚未发现故障；自 ${from} s 起判断。`,
  quiet: () => '没有故障，一切平静。',
  quietAgain: () => '所有故障都已结束。',
  ending: () => '故障已结束，报警即将解除。',
  one: ({name, kind, size, since}) => `${name}${kind ? ` ${kind}故障` : ''}：${size}，自 ${since} 起。`,
  oneFound: ({name, kind, size, since, took}) =>
    `${name}${kind ? ` ${kind}故障` : ''}：${size}，自 ${since} 起，${took} 后发现。`,
  oneAgain: ({name, kind, size, since, again}) =>
    `${name}${kind ? ` ${kind}故障` : ''}：${size}，自 ${since} 起。${again} 的新故障在该报警解除之前到来。`,
  several: ({count: n}) => `${n} 个故障，全部识别。`,
  allNamed: ({count: n, name, took}) => `${n} 个故障，全部识别。${name} 在出现 ${took} 后被发现。`,
  either: ({names}) => `${names.join(' 或 ')}：当前输入无法区分。`,
  unexplained: ({name}) => `模型中没有故障能解释 ${name}。请怀疑其传感器。`,
  looking: ({name, count: n, open}) =>
    n > 0 ? `已识别 ${n} 个故障。${name} 尚未发现。` : `存在 ${open} 个故障，尚未发现。`,
  hidden: ({name, count: n}) => `${n > 0 ? `已识别 ${n} 个故障。` : ''}${name} 存在但不可见：当前输入下不可辨识。`,
  measurement: ({name}) => `测量 ${name} 受到干扰，尚未发现。`,
  falseAlarm: ({name}) => `${name} 报警，但该处并无故障。`,
  blamed: ({name, otherName, onChannel}) =>
    onChannel ? `${otherName} 的故障被归咎于 ${name}。` : `测量 ${otherName} 的干扰被归咎于 ${name}。`,
};

export const sentences = () => (language() === 'zh' ? zh : en);
