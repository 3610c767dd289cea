<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>AI model:</source>
        <translation>KI-Modell:</translation>
    </message>
    <message>
        <source>AI models (*.onnx)</source>
        <translation>KI-Modelle (*.onnx)</translation>
    </message>
    <message>
        <source>AI output:</source>
        <translation>KI-Ausgabe:</translation>
    </message>
    <message>
        <source>AI stream:</source>
        <translation>KI-Datenstrom:</translation>
    </message>
    <message>
        <source>An AI model (a neural network) that says where bone is in a frame, as an ONNX file. It is run on this computer's processor, and nothing but this file and the JSON of its name is opened.</source>
        <translation>Ein KI-Modell (ein neuronales Netz), das sagt, wo in einem Bild Knochen ist, als ONNX-Datei. Es läuft auf dem Prozessor dieses Rechners, und nur diese Datei und die JSON-Datei ihres Namens werden geöffnet.</translation>
    </message>
    <message>
        <source>Bone of CT:</source>
        <translation>Knochen im CT:</translation>
    </message>
    <message>
        <source>Bone told by:</source>
        <translation>Knochen laut:</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>CT:</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>Verbindung</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>Live</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Mehr</translation>
    </message>
    <message>
        <source>More sweeps:</source>
        <translation>Weitere Schwenks:</translation>
    </message>
    <message>
        <source>Name under which the server sends what an AI model says (device), with the time stamps of its images</source>
        <translation>Name, unter dem der Server sendet, was ein KI-Modell sagt (Gerät), mit den Zeitstempeln seiner Bilder</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Keines</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>Noch keiner</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>Aufnahme, CT, Segmentierung öffnen ...</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>CT auf den Schwenk legen</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Rekonstruieren</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Aufnehmen</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>Aufgenommen</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>Sagen, wohin als Nächstes</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>Neu beginnen ...</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Stopp</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Schwenk und CT</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>Schwenk:</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>An einem Beispielpatienten ausprobieren</translation>
    </message>
    <message>
        <source>Use the scanned area</source>
        <translation>Gescannten Bereich nehmen</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>Wirbel:</translation>
    </message>
    <message>
        <source>What an AI model has said of the frames (predictions): a sequence of images, one for each frame or with their times, from 0 to 255 or from 0 to 1</source>
        <translation>Was ein KI-Modell zu den Bildern gesagt hat (Vorhersagen): eine Bildsequenz, eines für jedes Bild oder mit dessen Zeiten, von 0 bis 255 oder von 0 bis 1</translation>
    </message>
    <message>
        <source>Who says where bone is: the CT in its place, an AI model (a neural network) that looks at every frame, or the echoes, bright with darkness behind them. Only the CT knows bone that no frame shows.</source>
        <translation>Wer sagt, wo Knochen ist: das CT an seinem Ort, ein KI-Modell (ein neuronales Netz), das jedes Bild ansieht, oder die Echos, hell mit Dunkelheit dahinter. Nur das CT kennt Knochen, den kein Bild zeigt.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>nicht gestartet</translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <source>An AI model in a file needs the Python package onnxruntime, a download from the internet. Install it now?</source>
        <translation>Ein KI-Modell in einer Datei braucht das Python-Paket onnxruntime, das aus dem Internet geladen wird. Jetzt installieren?</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>Bone is known from {looked} of {frames} frames.</source>
        <translation>Knochen ist aus {looked} von {frames} Bildern bekannt.</translation>
    </message>
    <message>
        <source>CT agrees but for {bones}: {found}</source>
        <translation>CT stimmt überein, außer bei {bones}: {found}</translation>
    </message>
    <message>
        <source>CT agrees: {found}</source>
        <translation>CT stimmt überein: {found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>CT stimmt nicht überein: {found}</translation>
    </message>
    <message>
        <source>Do not trust the picture there, nor the names of the levels: the spine may have bent since the CT, or the CT lies one level off.</source>
        <translation>Dort weder dem Bild trauen noch den Namen der Höhen: Die Wirbelsäule kann sich seit dem CT gekrümmt haben, oder das CT liegt eine Höhe daneben.</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>Sonde langsamer führen: höchstens {fast:.0f} mm/s.</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>Erst das CT auf den Schwenk legen, dann dem Bild glauben.</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>{name} noch einmal scannen, aus anderen Winkeln.</translation>
    </message>
    <message>
        <source>expected to show: {shares}</source>
        <translation>voraussichtlich sichtbar: {shares}</translation>
    </message>
    <message>
        <source>known after “Reconstruct”</source>
        <translation>bekannt nach „Rekonstruieren“</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>noch kein Schwenk</translation>
    </message>
    <message>
        <source>onnxruntime was not installed, and an AI model in a file needs it: {why}</source>
        <translation>onnxruntime wurde nicht installiert, und ein KI-Modell in einer Datei braucht es: {why}</translation>
    </message>
    <message>
        <source>{count} predictions belong to no frame with a pose.</source>
        <translation>{count} Vorhersagen gehören zu keinem Bild mit einer Lage.</translation>
    </message>
    <message>
        <source>{frames}, probe at {speed:.0f} mm/s</source>
        <translation>{frames}, Sonde mit {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{packages} is not installed, and an AI model in a file needs it.</source>
        <translation>{packages} ist nicht installiert, und ein KI-Modell in einer Datei braucht es.</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes lie on its bone, {median:.1f} mm off in the median</source>
        <translation>{share:.0%} der Echos liegen auf seinem Knochen, im Median {median:.1f} mm daneben</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{used} von {frames} Bildern</translation>
    </message>
</context>
<context>
    <name>AIFReconScene.panelWords</name>
    <message>
        <source>The echoes themselves</source>
        <translation>Die Echos selbst</translation>
    </message>
    <message>
        <source>The output of the AI model belongs to one sweep; got {predictions} for {sweeps}. Leave the others out.</source>
        <translation>Die Ausgabe des KI-Modells gehört zu einem Schwenk; es sind {predictions} für {sweeps}. Die anderen weglassen.</translation>
    </message>
    <message>
        <source>{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the AI model has said of this sweep, in its size.</source>
        <translation>{name}: Vorhersagen von {got} Pixeln passen nicht zu Bildern von {frames}. Wählen, was das KI-Modell zu diesem Schwenk gesagt hat, in seiner Größe.</translation>
    </message>
</context>
<context>
    <name>Picture</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>Nur für die Forschung: nicht zum Führen einer Nadel.</translation>
    </message>
</context>
<context>
    <name>inputs.boneSource</name>
    <message>
        <source>An AI model in a file</source>
        <translation>Ein KI-Modell in einer Datei</translation>
    </message>
    <message>
        <source>An AI model that runs elsewhere</source>
        <translation>Ein KI-Modell, das anderswo läuft</translation>
    </message>
    <message>
        <source>An AI model, as it was recorded</source>
        <translation>Ein KI-Modell, wie es aufgenommen wurde</translation>
    </message>
    <message>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation>Knochen wird im Schwenk selbst gesucht: was hell ist, mit Dunkelheit dahinter. Die Dokumentation sagt, wie gut das geht.</translation>
    </message>
    <message>
        <source>Choose the file of the AI model, or choose another “Bone told by”.</source>
        <translation>Die Datei des KI-Modells wählen, oder ein anderes „Knochen laut“.</translation>
    </message>
    <message>
        <source>Enter the name under which the server sends what the AI model says, or choose another “Bone told by”.</source>
        <translation>Den Namen eingeben, unter dem der Server sendet, was das KI-Modell sagt, oder ein anderes „Knochen laut“ wählen.</translation>
    </message>
    <message>
        <source>Every label above 0 is bone.</source>
        <translation>Jedes Label über 0 ist Knochen.</translation>
    </message>
    <message>
        <source>Images and what the AI model says of them must have two names; both are {name}.</source>
        <translation>Bilder und das, was das KI-Modell zu ihnen sagt, brauchen zwei Namen; beide heißen {name}.</translation>
    </message>
    <message>
        <source>No bone selected: the sweep is averaged, and bone is not enhanced.</source>
        <translation>Kein Knochen gewählt: Der Schwenk wird gemittelt, und Knochen wird nicht hervorgehoben.</translation>
    </message>
    <message>
        <source>Select the recorded output of the AI model, or choose another “Bone told by”.</source>
        <translation>Die aufgenommene Ausgabe des KI-Modells wählen, oder ein anderes „Knochen laut“.</translation>
    </message>
    <message>
        <source>Taken for the probability of bone, from 0 to 1.</source>
        <translation>Gilt als Wahrscheinlichkeit von Knochen, von 0 bis 1.</translation>
    </message>
    <message>
        <source>The CT</source>
        <translation>Das CT</translation>
    </message>
    <message>
        <source>The echoes themselves</source>
        <translation>Die Echos selbst</translation>
    </message>
    <message>
        <source>The output of the AI model belongs to one sweep: leave the others out, or choose another “Bone told by”.</source>
        <translation>Die Ausgabe des KI-Modells gehört zu einem Schwenk: Die anderen weglassen, oder ein anderes „Knochen laut“ wählen.</translation>
    </message>
    <message>
        <source>There is no file {path}.</source>
        <translation>Es gibt keine Datei {path}.</translation>
    </message>
    <message>
        <source>What an AI model says comes from a server: take the images from there too, or choose another “Bone told by”.</source>
        <translation>Was ein KI-Modell sagt, kommt von einem Server: Auch die Bilder von dort nehmen, oder ein anderes „Knochen laut“ wählen.</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Open a recording, or select a tracked sweep.</source>
        <translation>Eine Aufnahme öffnen oder einen Schwenk wählen.</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>Registrierung</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>Verfolgung</translation>
    </message>
    <message>
        <source>being worked out ...</source>
        <translation>wird ermittelt ...</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Press Start</source>
        <translation>Start drücken</translation>
    </message>
    <message>
        <source>What the AI model said is in {path}.</source>
        <translation>Was das KI-Modell gesagt hat, ist in {path}.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>nicht gestartet</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>beendet</translation>
    </message>
</context>
<context>
    <name>panel.liveWords</name>
    <message>
        <source>Bring what is not seen into the tracker's view</source>
        <translation>Was nicht gesehen wird, in den Blick des Trackers bringen</translation>
    </message>
    <message>
        <source>Keep scanning</source>
        <translation>Weiter scannen</translation>
    </message>
    <message>
        <source>Probe seen</source>
        <translation>Sonde gesehen</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>Fertig.</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Schwenk und CT</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>Schwenk und CT: {names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>caution</source>
        <translation>Vorsicht</translation>
    </message>
    <message>
        <source>good</source>
        <translation>gut</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>noch offen</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>schlecht</translation>
    </message>
</context>
<context>
    <name>picture.sweepPage</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>Nur für die Forschung: nicht zum Führen einer Nadel.</translation>
    </message>
</context>
</TS>
