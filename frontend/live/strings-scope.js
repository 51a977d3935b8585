// The words of the scope, the timeline and the transport.

const en = {
  truth: 'true', estimate: 'estimate', band: '±2σ', alarm: 'alarm', faultActive: 'fault active', parentCurves: 'the session it was forked from',
  residual: 'residual', excitation: 'excitation', excited: 'excited', notExcited: 'too weak', threshold: 'threshold δ',
  window: 'Window', windowOf: (s) => `${s} s`, all: 'all', windowHint: 'How much time the scope shows',
  strips: 'Strips', stripsHint: 'Choose which curves are shown', channels: 'Faults', states: 'States', residuals: 'Residuals', other: 'Other',
  stripsUsual: 'Usual choice', zoomed: (a, b) => `${a} – ${b} s`, follow: 'Back to now', zoomHint: 'Drag over the curves to zoom, double-click to come back',
  lookingAt: (t) => `Looking at ${t} s`, continueHere: 'Continue from here', forkHere: 'Fork from here', backToNow: 'Back to now',
  continueHint: 'Go back to this time; what came after is given up', forkHint: 'A second session from here; this one stays as it is',
  timeline: 'Timeline of the session', timelineHint: 'Click or drag to look back',
  play: 'Play', pause: 'Pause', step: 'One step', toStart: 'Back to the start', fork: 'Fork: try something else from here, and compare', speed: 'Speed',
  fastest: 'as fast as it can', clock: 'Time in the plant', seconds: 's',
  openFigure: 'Open as a figure, to measure and to save', figure: 'Figure', close: 'Close', savePng: 'PNG', saveSvg: 'SVG', loadingFigure: 'Drawing …',
  loading: 'Setting up the plant and its observers …', nothingYet: 'Press play, and the curves begin here.', noStrips: 'No curve is shown. Choose some under Strips.',
  reconnecting: 'The connection is lost. The session goes on; the curves continue as soon as it is back.',
  sessionEnded: 'This session has ended.', full: 'This session has as many viewers as it may have.', failed: 'The session could not be opened.',
  startAgain: 'Start again from here', startNew: 'Start a new session', horizon: 'The end of what a session may reach. Fork from an earlier time, or start again.',
  plantEscaped: 'The plant has left all bounds: time stops here. Go back along the timeline.', diverged: 'diverged', divergedAt: (t) => `diverged at ${t} s`,
  hysteresis: 'Hysteresis', over: 'over', slots: 'each operator: a slot that its input pushes along', zones: 'Zones of the operators', rising: 'rising', falling: 'falling', memory: 'memory',
  forked: (t) => `A second session from ${t} s. The first goes on; its curves are the faint ones.`, viewOnly: 'You are watching. Only the one who opened this session can change it.', parentGone: 'The session it was forked from is gone.',
  wentBack: (t) => `Back at ${t} s. What came after is given up.`, undo: 'Undo', fromLink: (t) => `Opened from a link, at ${t} s. Press play to go on.`, damagedLink: 'This link is damaged: copy it again, completely.',
  describe: (title, values) => `${title}: ${values}`, begins: 'begins', gainChanged: 'gain changed',
};

const zh = {
  truth: '真值', estimate: '估计', band: '±2σ', alarm: '报警', faultActive: '故障存在', parentCurves: '分支前的会话',
  residual: '残差', excitation: '激励', excited: '充分激励', notExcited: '激励不足', threshold: '阈值 δ',
  window: '窗口', windowOf: (s) => `${s} s`, all: '全部', windowHint: '示波器显示的时间长度',
  strips: '曲线', stripsHint: '选择显示哪些曲线', channels: '故障', states: '状态', residuals: '残差', other: '其他',
  stripsUsual: '默认选择', zoomed: (a, b) => `${a} – ${b} s`, follow: '回到当前', zoomHint: '在曲线上拖动可放大，双击还原',
  lookingAt: (t) => `正在查看 ${t} s`, continueHere: '从此处继续', forkHere: '从此处分支', backToNow: '回到当前',
  continueHint: '回到这一时刻；其后的内容将被放弃', forkHint: '从此处开始第二个会话；当前会话保持不变',
  timeline: '会话时间轴', timelineHint: '点击或拖动以回看',
  play: '播放', pause: '暂停', step: '单步', toStart: '回到起点', fork: '分支：从此处另作尝试并比较', speed: '速度',
  fastest: '尽可能快', clock: '被控对象的时间', seconds: 's',
  openFigure: '以图形打开，便于测量和保存', figure: '图形', close: '关闭', savePng: 'PNG', saveSvg: 'SVG', loadingFigure: '正在绘制……',
  loading: '正在建立对象及其观测器……', nothingYet: '按下播放，曲线将从这里开始。', noStrips: '没有显示曲线。请在“曲线”中选择。',
  reconnecting: '连接已断开。会话仍在继续；恢复连接后曲线将接续。',
  sessionEnded: '该会话已结束。', full: '该会话的观看人数已满。', failed: '无法打开会话。',
  startAgain: '从此处重新开始', startNew: '新建会话', horizon: '已到会话允许的终点。请从较早的时刻分支，或重新开始。',
  plantEscaped: '对象已超出所有界限：时间在此停止。请沿时间轴返回。', diverged: '发散', divergedAt: (t) => `在 ${t} s 发散`,
  hysteresis: '迟滞回线', over: '对', slots: '每个算子：被输入推动的间隙', zones: '各算子的区域', rising: '上升', falling: '下降', memory: '记忆',
  forked: (t) => `自 ${t} s 起的第二个会话。原会话继续；其曲线以淡色显示。`, viewOnly: '您正在观看。只有会话的创建者可以更改。', parentGone: '分支前的会话已不存在。',
  wentBack: (t) => `已回到 ${t} s，其后的内容已放弃。`, undo: '撤销', fromLink: (t) => `由链接打开，时刻 ${t} s。按播放继续。`, damagedLink: '链接已损坏：请重新完整复制。',
  describe: (title, values) => `${title}：${values}`, begins: '开始', gainChanged: '增益改变',
};

export {en, zh};
