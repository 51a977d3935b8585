// What the diagnosis says, in Chinese: excitation, proposals, resolution, and why there is none (backend/diagnosis).

const NUMBER = '(-?[\\d.]+(?:e[-+]?\\d+)?)';
/** @param {string} text @param {string} made @returns {[RegExp, string]} */
const rule = (text, made) => [new RegExp(`^${text.replaceAll('#', NUMBER)}$`), made];

/** Names one after another: θ₁, θ₂ and θ₃. */
/** @type {import('./translator.js').Rule[]} */
const lists = [[/^([^ ,]+(?:, [^ ,]+)*) and ([^ ,]+)$/, '$1 和 $2']];

/** @type {import('./translator.js').Rule[]} */
export const diagnosisRules = [
  rule(
    '(.+) (?:is|are) not excited at all: (?:its|their) faults? would not show in any output now',
    '$1 完全没有被激励：其故障目前不会在任何输出中显现',
  ),
  rule(
    '(.+) shows too little now: a typical fault stands out # times above the noise, # times are asked for',
    '$1 目前显现得太少：典型故障高出噪声 $2 倍，要求 $3 倍',
  ),
  rule(
    '(.+) is told from the others too little now: it stands out # times, # times are asked for',
    '$1 目前与其他故障区分不足：高出 $2 倍，要求 $3 倍',
  ),
  rule(
    '(.+) show too little now: the least # times above the noise, # times are asked for',
    '$1 目前显现得太少：最小者高出噪声 $2 倍，要求 $3 倍',
  ),
  rule(
    '(.+) can hardly be told apart with this input: what tells them apart stands out # times above the noise, # times are asked for',
    '$1 在当前输入下几乎无法区分：区别只高出噪声 $2 倍，要求 $3 倍',
  ),
  rule(
    '(.+) can hardly be told apart with this input: only their combination (.+) shows',
    '$1 在当前输入下几乎无法区分：只有组合 $2 可见',
  ),
  rule(
    '(.+) can hardly be told apart with this input: only # combinations of them show',
    '$1 在当前输入下几乎无法区分：只有其中 $2 个组合可见',
  ),
  rule(
    '(.+) cannot be told apart with this input: what tells them apart stands out # times above the noise, # times are asked for',
    '$1 在当前输入下无法区分：区别只高出噪声 $2 倍，要求 $3 倍',
  ),
  rule(
    '(.+) cannot be told apart with this input: only their combination (.+) shows',
    '$1 在当前输入下无法区分：只有组合 $2 可见',
  ),
  rule(
    '(.+) cannot be told apart with this input: only # combinations of them show',
    '$1 在当前输入下无法区分：只有其中 $2 个组合可见',
  ),
  rule('the fault can be seen: a typical one stands out # times above the noise', '故障可见：典型故障高出噪声 $1 倍'),
  rule(
    'all faults can be told apart: the least visible combination stands out # times above the noise',
    '所有故障都可区分：最不可见的组合高出噪声 $1 倍',
  ),
  rule('the plant has no fault channels', '该对象没有故障通道'),
  rule('there are no data for this window', '该窗口内尚无信息'),

  rule('(.+) cannot be seen with this input', '$1 在当前输入下不可见'),
  rule('(.+): faults from # on are found and told from the others', '$1：大小自 $2 起的故障可被发现并与其他故障区分'),
  rule('(.+): faults from # on are found', '$1：大小自 $2 起的故障可被发现'),
  rule('(.+): the estimate is lost', '$1：估计已丢失'),
  rule(
    '(.+) cannot be resolved at this noise: it takes # to be told from the other faults within a window, a typical fault is #',
    '$1 在此噪声下无法分辨：须达 $2 才能在一个窗口内与其他故障区分，典型故障为 $3',
  ),
  rule(
    '(.+) cannot be resolved at the noise that is assumed where none is declared: it takes # to be told from the other faults within a window, a typical fault is #',
    '$1 在未声明噪声时所假定的噪声下无法分辨：须达 $2 才能在一个窗口内与其他故障区分，典型故障为 $3',
  ),
  rule(
    '(.+) cannot be resolved by this observer at this noise: its estimate scatters by #, a typical fault is #',
    '$1 在此噪声下无法由该观测器分辨：其估计的离散为 $2，典型故障为 $3',
  ),

  rule(
    'the input as it is tells the faults apart as far as any does: none is proposed',
    '现有输入已尽可能区分各故障：无需建议',
  ),
  rule('the plant has no input that could excite it', '该对象没有可以激励它的输入'),
  rule(
    '(.+) would tell the faults apart: the least visible combination would stand out # times above the noise instead of #',
    '$1可以区分各故障：最不可见的组合将高出噪声 $2 倍，而不是 $3 倍',
  ),
  rule(
    '(.+) would show the fault: a typical one would stand out # times above the noise instead of #',
    '$1可以显现故障：典型故障将高出噪声 $2 倍，而不是 $3 倍',
  ),
  rule(
    '(.+) would help: the least visible combination would stand out # times above the noise instead of #',
    '$1会有帮助：最不可见的组合将高出噪声 $2 倍，而不是 $3 倍',
  ),
  rule('# times are asked for', '要求 $1 倍'),
  rule('still (.+)', '仍然 $1'),
  rule(
    'a square wave of (.+?) between # and #( \\S+)? with a period of # s',
    '$1 在 $2 与 $3$4 之间、周期 $5 s 的方波',
  ),
  rule(
    'a sine of (.+?) about #( \\S+)? with amplitude #( \\S+)? and # Hz',
    '$1 以 $2$3 为中心、幅值 $4$5、频率 $6 Hz 的正弦',
  ),
  rule(
    '(.+?) jumping at random between # and #( \\S+)?, with a new value every # s,',
    '$1 在 $2 与 $3$4 之间每 $5 s 随机跳变一次',
  ),
  rule('a step of (.+?) to #( \\S+)?', '$1 阶跃到 $2$3'),
  rule('no course of an input that was tried helps, and (.+?): (.+)', '试过的输入都没有帮助，而且 $1：$2'),
  rule(
    'no course of (.+?) that was tried helps with the known signals \\((.+?)\\) as they are: (.+)',
    '在已知信号（$2）不变时，试过的 $1 的变化都没有帮助：$3',
  ),
  rule('no course of (.+?) that was tried helps: (.+)', '试过的 $1 的变化都没有帮助：$2'),

  rule('the plant has # states; the diagnosis handles at most #', '该对象有 $1 个状态，最多只处理 $2 个'),
  rule('the run has fewer than # rows', '运行不足 $1 行'),
  rule(
    '(.+) changes too much between two rows, # s apart, of which only the first value is used: record more often',
    '$1 在相隔 $2 s 的两行之间变化过大，只能看到前一行的值：请提高记录频率',
  ),
  rule("the filter does not stay finite along this plant's runs", '滤波器沿该对象的运行不能保持有限'),
  rule("the experiment's diagnosis is switched off", '未要求诊断'),
  rule('the observer estimates no fault', '它不估计故障'),
  rule(
    '(.+) cannot be told apart by any input, nor from the states? (.+)',
    '任何输入都无法区分 $1，也无法与状态 $2 区分',
  ),
  rule('(.+) cannot be told apart by any input', '任何输入都无法区分 $1'),
  rule('(.+) cannot be told from the states? (.+)', '$1 无法与状态 $2 区分'),
  rule('(.+) cannot be told from the outputs', '$1 无法由输出得知'),
  rule('(.+) shows? in no output', '$1 不在任何输出中显现'),
  ...lists,
];
